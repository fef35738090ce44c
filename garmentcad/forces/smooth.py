"""Functions without branches, calls or tables, so that loops over them use wide instructions. Errors are relative, against the functions of `math`."""

from __future__ import annotations

from garmentcad.arrays import kernel


@kernel
def expm1_smooth(x):  # type: ignore[no-untyped-def]
    """exp(x) - 1 for |x| <= 60: its series at x/1024, doubled ten times by expm1(2 z) = m (2 + m). Error below 1e-12 up to 10, 1e-11 beyond."""
    z = x * (1.0 / 1024.0)
    m = z * (1.0 + z * (1.0 / 2.0 + z * (1.0 / 6.0 + z * (1.0 / 24.0 + z * (1.0 / 120.0 + z * (1.0 / 720.0 + z * (1.0 / 5040.0)))))))
    m = m * (2.0 + m)
    m = m * (2.0 + m)
    m = m * (2.0 + m)
    m = m * (2.0 + m)
    m = m * (2.0 + m)
    m = m * (2.0 + m)
    m = m * (2.0 + m)
    m = m * (2.0 + m)
    m = m * (2.0 + m)
    return m * (2.0 + m)


@kernel
def arctan_over(z2):  # type: ignore[no-untyped-def]
    """atan(z)/z from z^2 for z^2 <= tan(pi/8)^2 = 0.1716, by its series. Error below 1e-12 there, below 1e-16 up to z^2 = 0.04."""
    tail = 1.0 / 17.0 - z2 * (1.0 / 19.0 - z2 * (1.0 / 21.0 - z2 * (1.0 / 23.0 - z2 * (1.0 / 25.0 - z2 * (1.0 / 27.0)))))
    return 1.0 - z2 * (
        1.0 / 3.0 - z2 * (1.0 / 5.0 - z2 * (1.0 / 7.0 - z2 * (1.0 / 9.0 - z2 * (1.0 / 11.0 - z2 * (1.0 / 13.0 - z2 * (1.0 / 15.0 - z2 * tail))))))
    )
