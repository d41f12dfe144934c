"""Colours of a recording: Okabe and Ito's palette, which colour-blind readers can tell apart."""

import numpy as np
import numpy.typing as npt

from fuzzynav_mj.types import FloatArray

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

RISK_SCALE: tuple[Colour, ...] = (BLUE, YELLOW, VERMILLION)  # at risk 0, 50 and 100


def risk_colours(risk: FloatArray) -> npt.NDArray[np.uint8]:
    """Colours (n, 3) of risks (n,) in 0..100 on `RISK_SCALE`; grey for nan."""
    scale = np.array(RISK_SCALE, dtype=np.float64)
    known = np.nan_to_num(risk)
    marks = np.linspace(0.0, 100.0, len(scale))
    colours = np.column_stack([np.interp(known, marks, channel) for channel in scale.T])
    colours[np.isnan(risk)] = GREY
    return np.round(colours).astype(np.uint8)
