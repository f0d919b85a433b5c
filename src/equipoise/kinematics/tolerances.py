"""How exactly loops are closed, and how carefully paths to closed poses are followed."""

CLOSED = 1e-13  # residual, as a share of the mechanism's size
ITERATIONS = 7
STALLED = 0.5  # Newton gives up when the residual shrinks less than this
STRAY = 0.3  # [rad, or share of the size] how far the closed pose may be from where the tangent led
SHORTEST = 0.002  # [rad, or share of the size] no shorter step is tried, but for a whole path
OPPOSITE = 1e-3  # least 1 + a . b: beyond it the equation of a hinge is continued linearly
LEAST = 1e-200  # an exactly singular matrix has a condition number, and is no fault
NEAR = 1e-6  # residual, as a share of the size: so small that a path is worth it
OPEN = 1e-3  # the same: too large for a closed pose
DESCENT, WINDOW = 60, 8  # steps of least squares, at most and between two looks at what they bring
STUCK = 0.5  # they have come to an end when a window shrinks the residual less than this
