"""jax-md's ccma_apply_positions moves atoms along the bond after the drift, not before: a free rotor slows, by O(h) in all."""

import jax
import numpy as np

jax.config.update("jax_enable_x64", True)

import jax.numpy as jnp  # noqa: E402
from jax_md import space  # noqa: E402
from jax_md.mm_forcefields.amber import constraints  # noqa: E402

masses, bonds, lengths = np.array([12.0, 12.0]), np.array([[0, 1]]), np.array([1.0])
_, ccma = constraints.prepare_settle_ccma(bonds, lengths, masses)
displacement, shift = space.free()
for h in (0.02, 0.01, 0.005):
    x, v = jnp.array([[-0.5, 0, 0], [0.5, 0, 0]]), jnp.array([[0, -0.5, 0], [0, 0.5, 0]])  # one radian in one time
    for _ in range(round(1 / h)):
        moved = constraints.ccma_apply_positions(x + h * v, ccma, jnp.array(masses), displacement, shift, 1e-12, 1000)
        v = constraints.ccma_apply_velocities(moved, (moved - x) / h, ccma, jnp.array(masses), displacement, 1e-12, 1000)
        x = moved
    print(f"h = {h}: angular momentum {12 * float(jnp.cross(x, v)[:, 2].sum()):.6f} of 6")
