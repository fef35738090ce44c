"""Conversion factors between the units of pattern makers and textile testers and SI. Multiply by them.

Source: definitions (1 gf = 9.80665e-3 N exactly); KES units as printed by the Kawabata testers.
"""

from __future__ import annotations

import math

GRAVITY_M_S2 = 9.81
MM_TO_M = 1e-3
M_TO_MM = 1e3
GF_CM_TO_N_M = 0.980665  # gf/cm -> N/m (tension, 2HG)
GF_CM_DEG_TO_N_M_RAD = 0.980665 * 180.0 / math.pi  # gf/(cm.deg) -> N/m per rad (G)
GF_CM2_CM_TO_N_M = 9.80665e-5  # gf.cm2/cm -> N.m (B)
GF_CM_CM_TO_N = 9.80665e-3  # gf.cm/cm -> N (2HB)
MG_CM2_TO_KG_M2 = 0.01  # mg/cm2 -> kg/m2 (W)
G_M2_TO_KG_M2 = 1e-3
PA_TO_KPA = 1e-3
