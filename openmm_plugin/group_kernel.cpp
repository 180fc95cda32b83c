#include "openmm_plugin/device_kernels.hpp"

namespace taut {

// A large cluster by a group of GROUP threads, with the law of kLawSource and the plan of group_plan.hpp. What a
// cluster works on lies in the device's memory: it has no room in registers. Every helper finds its data ready, and
// leaves them ready for all threads of the group.
const char* const kGroupSource = R"(
#define EACH(n, count) int n = LOCAL_ID; n < (count); n += LOCAL_SIZE

typedef struct {
  int atoms, bonds, entries, rounds;
  GLOBAL const int *ends, *row, *column, *roundStart, *pivots, *targetStart, *targets, *changeStart, *changes;
  GLOBAL const int *laterStart, *later, *bondsStart, *bondsOf;
  GLOBAL mixed4 *v, *y;                     // velocities with the inverse mass; the bonds' share of accelerations
  GLOBAL mixed4 *r, *next;                  // bonds, now and at the end of the step
  GLOBAL mixed *A, *b, *whole, *lambda;     // b follows A; whole: A's diagonal
} Cluster;

DEVICE mixed3 xyz(mixed4 q) {
  return make_mixed3(q.x, q.y, q.z);
}
DEVICE mixed4 with(mixed3 q, mixed w) {
  return make_mixed4(q.x, q.y, q.z, w);
}

DEVICE mixed largest(LOCAL_ARG mixed* all, mixed mine) {
  all[LOCAL_ID] = mine;
  SYNC_THREADS
  for (int beside = GROUP / 2; beside > 0; beside /= 2) {
    if (LOCAL_ID < beside && all[LOCAL_ID + beside] > all[LOCAL_ID]) all[LOCAL_ID] = all[LOCAL_ID + beside];
    SYNC_THREADS
  }
  const mixed found = all[0];
  SYNC_THREADS
  return found;
}

// A = J(left) M^-1 J(r)^T
DEVICE void couple(const Cluster* g, GLOBAL const mixed4* left) {
  for (EACH(e, g->entries)) {
    const int k = g->row[e], l = g->column[e], i = g->ends[2 * k], j = g->ends[2 * k + 1];
    const mixed common = shared(i, j, g->ends[2 * l], g->ends[2 * l + 1], g->v[i].w, g->v[j].w);
    const mixed value = common == 0 ? 0 : common * dot(xyz(left[k]), xyz(g->r[l]));
    g->A[e] = value;
    if (k == l) g->whole[k] = value;
  }
  SYNC_THREADS
}

// b becomes the solution of A b = b. Returns 0 where a bond depends on others.
DEVICE int solve(const Cluster* g, LOCAL_ARG mixed* scratch) {
  mixed dependent = 0;
  for (int n = 0; n < g->rounds; n++) {
    for (int p = g->roundStart[n] + LOCAL_ID; p < g->roundStart[n + 1]; p += LOCAL_SIZE) {
      const int k = g->pivots[p];
      const mixed pivot = g->A[k];
      if (!(pivot > SMALLEST_PIVOT * g->whole[k])) dependent = 1;
      g->A[k] = 1 / pivot;
    }
    SYNC_THREADS
    for (int t = g->targetStart[n] + LOCAL_ID; t < g->targetStart[n + 1]; t += LOCAL_SIZE) {
      mixed sum = 0;
      for (int m = g->changeStart[t]; m < g->changeStart[t + 1]; m++)
        sum += g->A[g->changes[3 * m]] * g->A[g->changes[3 * m + 1]] * g->A[g->changes[3 * m + 2]];
      g->A[g->targets[t]] -= sum;
    }
    SYNC_THREADS
  }
  for (int n = g->rounds - 1; n >= 0; n--) {
    for (int p = g->roundStart[n] + LOCAL_ID; p < g->roundStart[n + 1]; p += LOCAL_SIZE) {
      const int k = g->pivots[p];
      mixed sum = g->b[k];
      for (int m = g->laterStart[p]; m < g->laterStart[p + 1]; m++)
        sum -= g->A[g->later[2 * m]] * g->b[g->later[2 * m + 1]];
      g->b[k] = sum * g->A[k];
    }
    SYNC_THREADS
  }
  return largest(scratch, dependent) == 0;
}

// y = M^-1 J^T lambda
DEVICE void pull(const Cluster* g, GLOBAL const mixed* lambda) {
  for (EACH(i, g->atoms)) {
    mixed3 sum = make_mixed3(0, 0, 0);
    for (int n = g->bondsStart[i]; n < g->bondsStart[i + 1]; n++) {
      const int k = g->bondsOf[n];
      if (k > 0)
        sum += xyz(g->r[k - 1]) * lambda[k - 1];
      else
        sum -= xyz(g->r[-k - 1]) * lambda[-k - 1];
    }
    g->y[i] = with(sum * g->v[i].w, 0);
  }
  SYNC_THREADS
}

DEVICE mixed3 across(GLOBAL const mixed4* q, int i, int j) {
  return xyz(q[j]) - xyz(q[i]);
}

KERNEL void hold(ARGUMENTS, int atoms, int bonds, int entries, int rounds, GLOBAL const int* RESTRICT ends,
                 GLOBAL const int* RESTRICT row, GLOBAL const int* RESTRICT column,
                 GLOBAL const int* RESTRICT roundStart, GLOBAL const int* RESTRICT pivots,
                 GLOBAL const int* RESTRICT targetStart, GLOBAL const int* RESTRICT targets,
                 GLOBAL const int* RESTRICT changeStart, GLOBAL const int* RESTRICT changes,
                 GLOBAL const int* RESTRICT laterStart, GLOBAL const int* RESTRICT later,
                 GLOBAL const int* RESTRICT bondsStart, GLOBAL const int* RESTRICT bondsOf,
                 GLOBAL mixed4* atomRoom, GLOBAL mixed4* bondRoom, GLOBAL mixed* numberRoom) {
  LOCAL mixed scratch[GROUP];
  const mixed unit = 1 / (mixed) 0x100000000;
  Cluster g;
  g.atoms = atoms, g.bonds = bonds, g.entries = entries, g.rounds = rounds;
  g.ends = ends, g.row = row, g.column = column, g.roundStart = roundStart, g.pivots = pivots;
  g.targetStart = targetStart, g.targets = targets, g.changeStart = changeStart, g.changes = changes;
  g.laterStart = laterStart, g.later = later, g.bondsStart = bondsStart, g.bondsOf = bondsOf;
  for (int c = GROUP_ID; c < clusters; c += NUM_GROUPS) {
    g.v = atomRoom + 5 * atoms * c, g.y = g.v + atoms;
    GLOBAL mixed4 *a = g.y + atoms, *pushed = a + atoms, *jump = pushed + atoms;  // a: without the bonds' share
    g.r = bondRoom + 2 * bonds * c, g.next = g.r + bonds;
    g.A = numberRoom + (entries + 3 * bonds) * c, g.b = g.A + entries, g.whole = g.b + bonds;
    g.lambda = g.whole + bonds;
    int failed = 0;

    for (EACH(i, atoms)) {
      const int s = atomsOf[i * clusters + c];
      const mixed4 v = velm[s];
      const mixed scale = v.w * unit;
      const mixed3 free = make_mixed3(scale * force[s], scale * force[s + paddedAtoms],
                                      scale * force[s + 2 * paddedAtoms]);
      g.v[i] = v.w == 0 ? make_mixed4(0, 0, 0, 0) : v;
      a[i] = with(free, 0);
#ifdef LANGEVIN
      const mixed4 last = jumps[atomIndex[s]];
      const float4 drawn = normal[firstNormal + s];
      const mixed3 before = lastH == 0 ? make_mixed3(0, 0, 0) : xyz(last);
      const mixed3 n = make_mixed3(drawn.x, drawn.y, drawn.z);
      jump[i] = with((mixed) 0.5 * ((keep - 1) * (xyz(v) + before + kick * free) + (width * sqrt(v.w)) * n), 0);
      if (v.w == 0) jump[i] = make_mixed4(0, 0, 0, 0);
      pushed[i] = with(free + before * (1 / kick), 0);
#else
      pushed[i] = a[i];
#endif
    }
    mixed worst = 0;
    const int home = homes[atomIndex[atomsOf[c]]], stride = bonds * clusters;
    for (EACH(k, bonds)) {
      const int i = atomsOf[ends[2 * k] * clusters + c], j = atomsOf[ends[2 * k + 1] * clusters + c];
      const real4 p = posq[i], q = posq[j];
      mixed3 r = make_mixed3(q.x - (mixed) p.x, q.y - (mixed) p.y, q.z - (mixed) p.z);
#ifdef USE_MIXED_PRECISION
      const real4 e = correction[i], f = correction[j];
      r += make_mixed3(f.x - (mixed) e.x, f.y - (mixed) e.y, f.z - (mixed) e.z);
#endif
      g.r[k] = with(r, 0);
      if (broken(r, lengths[k * clusters + c])) worst = 1;
      const int at = k * clusters + home;
      const mixed last = past[at], before = past[at + stride];
      g.lambda[k] = one * last + two * before + three * past[at + 2 * stride];
      past[at + 2 * stride] = before;
      past[at + stride] = last;
    }
    if (largest(scratch, worst) > 0) failed = 4;

#ifdef LANGEVIN
    couple(&g, g.r);
    for (EACH(k, bonds)) g.b[k] = dot(xyz(g.r[k]), across(jump, ends[2 * k], ends[2 * k + 1]));
    SYNC_THREADS
    if (!solve(&g, scratch)) failed = 3;
    pull(&g, g.b);
    for (EACH(i, atoms)) {
      const mixed3 held = xyz(jump[i]) - xyz(g.y[i]);
      jump[i] = with(held, 0);
      pushed[i] = with(xyz(pushed[i]) + held * (1 / kick), 0);
    }
    SYNC_THREADS
#endif

    int again = 1;
    for (int n = 0; n < MOST_SOLVES && again && !failed; n++) {
      mixed mine = 0;
      pull(&g, g.lambda);
      for (EACH(k, bonds)) {
        const int i = ends[2 * k], j = ends[2 * k + 1];
        const mixed3 r = xyz(g.r[k]), late = across(g.v, i, j);
        const mixed d = lengths[k * clusters + c];
        const mixed3 next = bondAtEnd(r, late, across(pushed, i, j) + across(g.y, i, j), h, kick);
        const mixed target = wanted(r, late, d, gains[k * clusters + c], gains[(bonds + k) * clusters + c], h, lastH);
        const mixed off = sigma(next, d) - target, part = turnOf(next, r, off);
        g.next[k] = with(next, 0);
        g.b[k] = -off / (h * kick);
        if (part > mine) mine = part;
      }
      const mixed turn = largest(scratch, mine);
      couple(&g, g.next);
      if (!(turn < 1000))
        failed = 2;
      else if (!solve(&g, scratch))
        failed = 3;
      for (EACH(k, bonds)) g.lambda[k] += g.b[k];
      SYNC_THREADS
      again = !((mixed) 0.5 * turn * turn <= TOLERANCE);
    }
    if (again && !failed) failed = 1;
    for (EACH(k, bonds)) past[k * clusters + home] = g.lambda[k];
    pull(&g, g.lambda);
    if (failed && LOCAL_ID == 0 && failure[0] == 0) {
      failure[0] = failed;
      failure[1] = atomIndex[atomsOf[c]];
    }

    for (EACH(i, atoms)) {
      const int s = atomsOf[i * clusters + c], atom = atomIndex[s];
      const mixed w = g.v[i].w;
      if (w == 0) continue;  // it never moves, and may belong to other clusters, too
      const mixed3 whole = xyz(a[i]) + xyz(g.y[i]);
      kept[atom] = with(whole, 0);
      mixed3 full = xyz(g.v[i]) + ((mixed) 0.5 * lastH) * whole;
#ifdef LANGEVIN
      if (lastH != 0) full += xyz(jumps[atom]);
      jumps[atom] = jump[i];
#endif
      velm[s] = with(full, w);
    }
    SYNC_THREADS
  }
}
)";

}  // namespace taut
