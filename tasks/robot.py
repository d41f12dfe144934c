"""The differential-drive robot as a composer entity."""

from xml.etree import ElementTree

from dm_control import composer, mjcf

from fuzzynav_mj.assets import model_path


class DiffDrive(composer.Robot):
    """The square robot of `models/robots/diff_drive.xml`.

    The file's free joint, range sensors and their sites are left out: the arena adds the free
    joint where composer needs it, and the lidar casts the same rays itself, at the decision rate
    only.
    """

    def _build(self, name: str = "robot") -> None:
        with model_path("robots/diff_drive.xml") as path:
            tree = ElementTree.parse(path).getroot()
        for parent in list(tree.iter()):
            for child in list(parent):
                if child.tag in ("freejoint", "replicate", "rangefinder"):
                    parent.remove(child)
        self._mjcf_root = mjcf.from_xml_string(ElementTree.tostring(tree, encoding="unicode"))
        self._mjcf_root.model = name

    @property
    def mjcf_model(self) -> mjcf.RootElement:
        """The robot's model."""
        return self._mjcf_root

    @property
    def actuators(self) -> list[mjcf.Element]:
        """Velocity servos of the left and the right wheel."""
        return [self._mjcf_root.find("actuator", f"drive_{side}") for side in ("left", "right")]

    @property
    def chassis(self) -> mjcf.Element:
        """The body whose frame is the footprint's centre on the floor."""
        return self._mjcf_root.find("body", "chassis")
