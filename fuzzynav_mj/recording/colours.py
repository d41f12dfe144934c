"""Colours of a recording: Okabe and Ito's palette, which colour-blind readers can tell apart."""

import numpy as np
import numpy.typing as npt

from fuzzynav_mj.types import BoolArray, FloatArray

Colour = tuple[int, int, int]

BLACK: Colour = (0, 0, 0)
ORANGE: Colour = (230, 159, 0)
SKY_BLUE: Colour = (86, 180, 233)
GREEN: Colour = (0, 158, 115)
YELLOW: Colour = (240, 228, 66)
BLUE: Colour = (0, 114, 178)
VERMILLION: Colour = (213, 94, 0)
PURPLE: Colour = (204, 121, 167)
GREY: Colour = (140, 140, 140)
SLATE: Colour = (120, 145, 180)
BROWN: Colour = (115, 75, 50)

RISK_SCALE: tuple[Colour, ...] = (BLUE, YELLOW, VERMILLION)  # at risk 0, 50 and 100


def candidate_colours(risk: FloatArray, admissible: BoolArray) -> npt.NDArray[np.uint8]:
    """Colours (n, 3) of next positions: `RISK_SCALE` where the risk (n,) in 0..100 is known.

    Where it is nan, slate or brown, which differ in hue and lightness, tell whether the next
    position is admissible (n,).
    """
    scale = np.array(RISK_SCALE, dtype=np.float64)
    known = np.nan_to_num(risk)
    marks = np.linspace(0.0, 100.0, len(scale))
    colours = np.column_stack([np.interp(known, marks, channel) for channel in scale.T])
    unknown = np.isnan(risk)
    colours[unknown & admissible] = SLATE
    colours[unknown & ~admissible] = BROWN
    return np.round(colours).astype(np.uint8)
