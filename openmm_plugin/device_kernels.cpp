#include "openmm_plugin/device_kernels.hpp"

namespace taut {

// Arrays over slots have the order of the device, which OpenMM changes now and then among equal molecules. What this
// step keeps (accelerations, jumps, multipliers) has the order of the System, so that it needs no reordering.

// v += ½h a, with the thermostat's ½Δ, then x += h v.
const char* const kDriftSource = R"(
KERNEL void drift(int atoms, mixed h, GLOBAL real4* RESTRICT posq, GLOBAL mixed4* RESTRICT velm,
                  GLOBAL const int* RESTRICT atomIndex, GLOBAL const mixed4* RESTRICT kept,
                  GLOBAL const mixed4* RESTRICT jumps
#ifdef USE_MIXED_PRECISION
                  , GLOBAL real4* RESTRICT correction
#endif
                  ) {
  for (int i = GLOBAL_ID; i < atoms; i += GLOBAL_SIZE) {
    mixed4 v = velm[i];
    if (v.w == 0) continue;  // a virtual site, or an atom that never moves
    const mixed4 a = kept[atomIndex[i]];
    v.x += (mixed) 0.5 * h * a.x;
    v.y += (mixed) 0.5 * h * a.y;
    v.z += (mixed) 0.5 * h * a.z;
#ifdef LANGEVIN
    const mixed4 jump = jumps[atomIndex[i]];
    v.x += jump.x;
    v.y += jump.y;
    v.z += jump.z;
#endif
    velm[i] = v;
    const real4 at = posq[i];
#ifdef USE_MIXED_PRECISION
    const real4 rest = correction[i];
    const mixed x = at.x + (mixed) rest.x + h * v.x;
    const mixed y = at.y + (mixed) rest.y + h * v.y;
    const mixed z = at.z + (mixed) rest.z + h * v.z;
    correction[i] = make_real4((real) (x - (real) x), (real) (y - (real) y), (real) (z - (real) z), 0);
#else
    const mixed x = at.x + h * v.x, y = at.y + h * v.y, z = at.z + h * v.z;
#endif
    posq[i] = make_real4((real) x, (real) y, (real) z, at.w);
  }
}
)";

// What a bond asks for, the same for a cluster of one thread and of a group. `h` is the length of the step to come,
// `kick` how long the forces act (md/constraint_method.hpp, Push), `lastH` the length of the step that has ended.
// Failures: 1 no convergence, 2 ran away, 3 singular, 4 a bond broke.
const char* const kLawSource = R"(
DEVICE int broken(mixed3 r, mixed d) {
  return !(fabs((mixed) 0.5 * (dot(r, r) - d * d)) < (mixed) 0.5 * d * d);
}

// What bonds k and l share of J M⁻¹ Jᵀ but for r_k·r_l: ±1/m of their common atom.
DEVICE mixed shared(int firstK, int secondK, int firstL, int secondL, mixed ofFirst, mixed ofSecond) {
  mixed sum = 0;
  if (firstK == firstL) sum += ofFirst;
  if (secondK == secondL) sum += ofSecond;
  if (firstK == secondL) sum -= ofFirst;
  if (secondK == firstL) sum -= ofSecond;
  return sum;
}

// Arguments of `hold`, of a thread's clusters and of a group's: DeviceStep::make_hold() adds them in this order.
#ifdef USE_MIXED_PRECISION
#define CORRECTION , GLOBAL const real4* RESTRICT correction
#else
#define CORRECTION
#endif
#define ARGUMENTS \
  int clusters, int paddedAtoms, mixed h, mixed kick, mixed lastH, mixed one, mixed two, mixed three, \
  GLOBAL const real4* RESTRICT posq, GLOBAL mixed4* RESTRICT velm, GLOBAL const mm_long* RESTRICT force, \
  GLOBAL const int* RESTRICT atomIndex, GLOBAL mixed4* RESTRICT kept, GLOBAL mixed4* RESTRICT jumps, \
  GLOBAL const float4* RESTRICT normal, int firstNormal, mixed keep, mixed width, GLOBAL int* RESTRICT failure, \
  GLOBAL const int* RESTRICT atomsOf, GLOBAL const int* RESTRICT homes, GLOBAL const mixed* RESTRICT lengths, \
  GLOBAL const mixed* RESTRICT gains, GLOBAL mixed* RESTRICT past CORRECTION

// The bond at the end of the step to come: `late` is the relative velocity, `whole` the relative acceleration.
DEVICE mixed3 bondAtEnd(mixed3 r, mixed3 late, mixed3 whole, mixed h, mixed kick) {
  return r + h * late + (h * kick) * whole;
}

DEVICE mixed sigma(mixed3 r, mixed d) {
  return (mixed) 0.5 * (dot(r, r) - d * d);
}

// tau, the sigma that Baumgarte's law wants at the end of the step (constraints/methods/baumgarte.hpp).
DEVICE mixed wanted(mixed3 r, mixed3 late, mixed d, mixed alpha2, mixed beta2, mixed h, mixed lastH) {
  if (lastH == 0) return (1 - (mixed) 0.5 * beta2 * h * h) * sigma(r, d);  // at the start nothing moves along it
  const mixed damping = (mixed) 0.5 * alpha2 * h;
  return ((2 - beta2 * h * h) * sigma(r, d) - (1 - damping) * sigma(r - lastH * late, d)) / (1 + damping);
}

// Where numbers ran away it is 1000, which is too much.
DEVICE mixed turnOf(mixed3 next, mixed3 r, mixed off) {
  const mixed part = fabs(off / dot(next, r));
  return part < 1000 ? part : 1000;
}
)";

// ATOMS, BONDS, FIRST and SECOND are the shape's: the atoms of bond k are FIRST[k] and SECOND[k].
const char* const kHoldSource = R"(
#if BONDS > 0
// b becomes the solution of A b = b, by elimination without pivoting. Returns 0 where a bond depends on others.
DEVICE int solve(mixed* A, mixed* b) {
  int independent = 1;
  mixed whole[BONDS];
  for (int k = 0; k < BONDS; k++) whole[k] = A[k * BONDS + k];
  for (int k = 0; k < BONDS; k++) {
    const mixed pivot = A[k * BONDS + k];
    if (!(pivot > SMALLEST_PIVOT * whole[k])) independent = 0;
    const mixed inverse = 1 / pivot;
    for (int l = k + 1; l < BONDS; l++) {
      const mixed factor = A[l * BONDS + k] * inverse;
      for (int m = k + 1; m < BONDS; m++) A[l * BONDS + m] -= factor * A[k * BONDS + m];
      b[l] -= factor * b[k];
    }
  }
  for (int k = BONDS - 1; k >= 0; k--) {
    for (int m = k + 1; m < BONDS; m++) b[k] -= A[k * BONDS + m] * b[m];
    b[k] /= A[k * BONDS + k];
  }
  return independent;
}

// A = J(left) M⁻¹ J(right)ᵀ
DEVICE void couple(mixed* A, const mixed3* left, const mixed3* right, const mixed* w) {
  const int first[BONDS] = {FIRST}, second[BONDS] = {SECOND};
  for (int k = 0; k < BONDS; k++)
    for (int l = 0; l < BONDS; l++) {
      const mixed common = shared(first[k], second[k], first[l], second[l], w[first[k]], w[second[k]]);
      A[k * BONDS + l] = common == 0 ? 0 : common * dot(left[k], right[l]);
    }
}

// y = M⁻¹Jᵀλ
DEVICE void pull(mixed3* y, const mixed3* r, const mixed* lambda, const mixed* w) {
  const int first[BONDS] = {FIRST}, second[BONDS] = {SECOND};
  for (int i = 0; i < ATOMS; i++) y[i] = make_mixed3(0, 0, 0);
  for (int k = 0; k < BONDS; k++) {
    y[first[k]] -= r[k] * (w[first[k]] * lambda[k]);
    y[second[k]] += r[k] * (w[second[k]] * lambda[k]);
  }
}
#endif

KERNEL void hold(ARGUMENTS) {
  const mixed unit = 1 / (mixed) 0x100000000;
  for (int c = GLOBAL_ID; c < clusters; c += GLOBAL_SIZE) {
    int slot[ATOMS], atom[ATOMS];
    mixed w[ATOMS];
    mixed3 v[ATOMS], a[ATOMS], y[ATOMS];  // a: without the bonds' share, y: the bonds' share
    for (int i = 0; i < ATOMS; i++) {
      const int s = atomsOf[i * clusters + c];
      slot[i] = s;
      atom[i] = atomIndex[s];
      const mixed4 moving = velm[s];
      w[i] = moving.w;
      v[i] = make_mixed3(moving.x, moving.y, moving.z);
      const mixed scale = w[i] * unit;
      a[i] = make_mixed3(scale * force[s], scale * force[s + paddedAtoms], scale * force[s + 2 * paddedAtoms]);
      y[i] = make_mixed3(0, 0, 0);
    }
#if BONDS > 0
    const int first[BONDS] = {FIRST}, second[BONDS] = {SECOND};
    mixed3 x[ATOMS], r[BONDS];
    for (int i = 0; i < ATOMS; i++) {
      const real4 at = posq[slot[i]];
#ifdef USE_MIXED_PRECISION
      const real4 rest = correction[slot[i]];
      x[i] = make_mixed3(at.x + (mixed) rest.x, at.y + (mixed) rest.y, at.z + (mixed) rest.z);
#else
      x[i] = make_mixed3(at.x, at.y, at.z);
#endif
    }
    for (int k = 0; k < BONDS; k++) r[k] = x[second[k]] - x[first[k]];
    mixed A[BONDS * BONDS], b[BONDS];
    int failed = 0;
#endif

    mixed3 pushed[ATOMS];  // a with the thermostat's share
    for (int i = 0; i < ATOMS; i++) pushed[i] = a[i];
#ifdef LANGEVIN
    mixed3 jump[ATOMS];
    for (int i = 0; i < ATOMS; i++) {
      mixed3 before = make_mixed3(0, 0, 0);
      if (lastH != 0) {
        const mixed4 last = jumps[atom[i]];
        before = make_mixed3(last.x, last.y, last.z);
      }
      v[i] += before;
      const float4 drawn = normal[firstNormal + slot[i]];
      const mixed3 n = make_mixed3(drawn.x, drawn.y, drawn.z);
      jump[i] = (mixed) 0.5 * ((keep - 1) * (v[i] + kick * a[i]) + (width * sqrt(w[i])) * n);
      pushed[i] += before * (1 / kick);
      v[i] -= before;
    }
#if BONDS > 0
    couple(A, r, r, w);
    for (int k = 0; k < BONDS; k++) b[k] = dot(r[k], jump[second[k]] - jump[first[k]]);
    if (!solve(A, b)) failed = 3;
    pull(y, r, b, w);
    for (int i = 0; i < ATOMS; i++) jump[i] -= y[i];
#endif
    for (int i = 0; i < ATOMS; i++) pushed[i] += jump[i] * (1 / kick);
#endif

#if BONDS > 0
    const int home = homes[atom[0]], stride = BONDS * clusters;
    mixed lambda[BONDS];
    for (int k = 0; k < BONDS; k++) {
      const int at = k * clusters + home;
      const mixed last = past[at], before = past[at + stride];
      lambda[k] = one * last + two * before + three * past[at + 2 * stride];
      past[at + 2 * stride] = before;
      past[at + stride] = last;
    }
    for (int k = 0; k < BONDS; k++)
      if (broken(r[k], lengths[k * clusters + c])) failed = 4;
    mixed target[BONDS];
    for (int k = 0; k < BONDS; k++)
      target[k] = wanted(r[k], v[second[k]] - v[first[k]], lengths[k * clusters + c], gains[k * clusters + c],
                         gains[(BONDS + k) * clusters + c], h, lastH);
    int again = 1;
    for (int n = 0; n < MOST_SOLVES && again && !failed; n++) {
      mixed3 next[BONDS];
      mixed turn = 0;
      pull(y, r, lambda, w);
      for (int k = 0; k < BONDS; k++) {
        const int i = first[k], j = second[k];
        next[k] = bondAtEnd(r[k], v[j] - v[i], pushed[j] - pushed[i] + y[j] - y[i], h, kick);
        const mixed off = sigma(next[k], lengths[k * clusters + c]) - target[k], part = turnOf(next[k], r[k], off);
        b[k] = -off / (h * kick);
        if (part > turn) turn = part;
      }
      couple(A, next, r, w);
      if (!(turn < 1000))
        failed = 2;
      else if (!solve(A, b))
        failed = 3;
      for (int k = 0; k < BONDS; k++) lambda[k] += b[k];
      again = !((mixed) 0.5 * turn * turn <= TOLERANCE);
    }
    if (again && !failed) failed = 1;
    for (int k = 0; k < BONDS; k++) past[k * clusters + home] = lambda[k];
    pull(y, r, lambda, w);
    if (failed && failure[0] == 0) {
      failure[0] = failed;
      failure[1] = atom[0];
    }
#endif

    for (int i = 0; i < ATOMS; i++) {
      const mixed3 whole = a[i] + y[i];
      kept[atom[i]] = make_mixed4(whole.x, whole.y, whole.z, 0);
      mixed3 full = v[i] + ((mixed) 0.5 * lastH) * whole;
#ifdef LANGEVIN
      if (lastH != 0) {
        const mixed4 last = jumps[atom[i]];
        full += make_mixed3(last.x, last.y, last.z);
      }
      jumps[atom[i]] = make_mixed4(jump[i].x, jump[i].y, jump[i].z, 0);
#endif
      velm[slot[i]] = make_mixed4(full.x, full.y, full.z, w[i]);
    }
  }
}
)";

}  // namespace taut
