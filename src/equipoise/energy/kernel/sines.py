"""Sine and cosine as polynomials, the same in every compiled kernel.

``x = k pi + r`` with |r| <= pi/2; ``sin x = (-1)^k sin r``. pi is split in two parts, the first with 33 bits, so that
k times it is exact for k below 2^20: |x| <= `FARTHEST`. The polynomials interpolate at Chebyshev's points: sin within
7e-16, cos within 2e-17 on +-pi/2, both within 1.2e-15 absolute with rounding.
"""

from __future__ import annotations

INVERSE_PI = 0.3183098861837907
PI_HIGH, PI_LOW = 3.1415926534682512, 1.2154201013012384e-10
ROUND = 6755399441055744.0  # 1.5 * 2^52: added and subtracted it rounds to a whole number, whose parity is the last bit
FARTHEST = 3.2e6  # [rad]

# sin r = r + r z P(z), cos r = 1 + z Q(z), z = r r; lowest power first
SIN = (
    -0.1666666666666665,
    0.008333333333325933,
    -0.00019841269836468978,
    2.7557318055676495e-06,
    -2.5051972920738918e-08,
    1.6050972212176875e-10,
    -7.408054418624224e-13,
)
COS = (
    -0.5,
    0.04166666666666634,
    -0.0013888888888860709,
    2.4801587292446122e-05,
    -2.7557317767308945e-07,
    2.087663086667205e-09,
    -1.1464689861744774e-11,
    4.6276756860773096e-14,
)
