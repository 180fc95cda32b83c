"""jax-md's settle_apply_positions, given a water that keeps the bonds already, turns it: it ought to leave it alone."""

import jax
import numpy as np

jax.config.update("jax_enable_x64", True)

import jax.numpy as jnp  # noqa: E402
from jax_md import space  # noqa: E402
from jax_md.mm_forcefields.amber import constraints  # noqa: E402

half = np.radians(104.52) / 2
water = 0.9572 * np.array([[0, 0, 0], [np.sin(half), np.cos(half), 0], [-np.sin(half), np.cos(half), 0]])
masses = np.array([15.9994, 1.008, 1.008])
bonds = np.array([[0, 1], [0, 2], [1, 2]])
lengths = np.array([0.9572, 0.9572, np.linalg.norm(water[1] - water[2])])
settle, _ = constraints.prepare_settle_ccma(bonds, lengths, masses)
displacement, shift = space.free()
held = constraints.settle_apply_positions(
    jnp.array(water), jnp.array(water), settle, jnp.array(masses), displacement, shift)
print("before", water.round(4).tolist())
print("after ", np.array(held).round(4).tolist())
