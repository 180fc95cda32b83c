// Runs kernels that solve systems of equations over their parts. Compiled once for each SIMD target.
#if defined(TAUT_SOLVING_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TAUT_SOLVING_INL_H
#undef TAUT_SOLVING_INL_H
#else
#define TAUT_SOLVING_INL_H
#endif

#include <optional>

#include "constraints/batch/elimination-inl.hpp"
#include "constraints/batch/solving.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

// The system of equations of one part.
struct Equations {
  double* b;
  Matrix A;
};

template <class Shape>
HWY_INLINE Equations equations(const Shape shape, Scratch& scratch) {
  const SystemRows rows(shape.size(), shape.entries());
  double* first = scratch.take(rows.end);
  return {first + rows.b * kLanes,
          {first + rows.d * kLanes, first + rows.inv_d * kLanes, first + rows.l * kLanes,
           first + rows.u * kLanes}};
}

// The piece before a separator owns its row; the piece after it only adds the result of its elimination.
template <class Shape>
HWY_INLINE void leave_left_separator(const Shape shape, const Part& part, double* rows) {
  if constexpr (Shape::kPieces)
    if (part.batch.left > 0) store(hn::Zero(D()), rows + shape.eliminated() * kLanes);
}

// Factors A of the bonds r, whose diagonal is given, into L D Lᵀ (with r_next, A' into L D U), and applies
// the forward substitution to b. Returns false if a bond depends on others.
template <class Shape>
HWY_INLINE bool factor(const Shape shape, const Part& part, const Equations& eq, const double* r,
                       SolveStats& stats) {
  leave_left_separator(shape, part, eq.A.d);
  leave_left_separator(shape, part, eq.b);
  const M regular = eliminate(shape, eq.A, r, eq.b);
  if constexpr (Shape::kPieces) {
    const int last =
        (shape.entries() - 1) * kLanes;  // the coupling of the separators, on both sides of the diagonal
    if (part.batch.piece()) store(load(eq.A.l + last), eq.A.u + last);
  }
  return accept(part, regular, eq.A.d, stats);
}
template <class Shape>
HWY_INLINE bool factor(const Shape shape, const Part& part, const Equations& eq, const double* r_next,
                       const double* r, SolveStats& stats) {
  leave_left_separator(shape, part, eq.A.d);
  leave_left_separator(shape, part, eq.b);
  return accept(part, eliminate_turned(shape, eq.A, r_next, r, eq.b), eq.A.d, stats);
}

// b ← L⁻¹b
template <class Shape>
HWY_INLINE void substitute_forward(const Shape shape, const Part& part, const Equations& eq) {
  leave_left_separator(shape, part, eq.b);
  substitute_forward(shape, eq.A.l, eq.b);
}

// A kernel K<Shape>, of one part, has
//     K(shape, batch, step, part, scratch)
//     SolveNext start(stats)                loads, and sets up the right-hand side
//     bool forward(solves, stats)           eliminates or substitutes forward; false if there is no solution
//     SolveNext apply(next, solves, stats)  applies the solution; sets up again unless it was the last solve
//     void end(stats)                       stores
// and x (the rows of positions, or null if they do not change), eq, and kOnceMostly (one solve is the rule).
// The stats are the part's own, except that max_residual starts from the largest one known: smaller residuals
// are not recorded. If a part gives up, its own residuals are recorded, but the bond that it has named stays.
inline HWY_NOINLINE void give_up(const Part& part, const double* x, double* relative, SolveStats& stats) {
  const int named = stats.worst_bond;
  stats.max_residual = 0;
  if (x == nullptr) return;
  find_residuals(part.batch, x, relative);
  record_largest(part, relative, stats);
  if (named >= 0) stats.worst_bond = named;
}

// The first solve, often the only one, is outside of the loop, and no path continues after giving up, so that
// the rows of small clusters stay in registers.
template <class Kernel>
HWY_INLINE void solve_whole(Kernel& kernel, const Part& part, SolveStats& stats) {
  SolveNext next = kernel.start(stats);
  if (!stats.converged()) return give_up(part, kernel.x, kernel.eq.b, stats);
  int solves = 0;
  if (Kernel::kOnceMostly && next != SolveNext::kEnd) {
    if (!kernel.forward(0, stats)) return give_up(part, kernel.x, kernel.eq.b, stats);
    kernel.back();
    next = kernel.apply(next, ++solves, stats);
  }
  while (next != SolveNext::kEnd) {
    if (!kernel.forward(solves, stats)) return give_up(part, kernel.x, kernel.eq.b, stats);
    kernel.back();
    next = kernel.apply(next, ++solves, stats);
  }
  kernel.end(stats);
  stats.iterations = solves;
  if (!stats.converged()) give_up(part, kernel.x, kernel.eq.b, stats);
}

// Runs one stage of a piece, and returns what it needs next. Residuals up to known_residual are not recorded.
template <class Kernel>
HWY_INLINE SolveNext solve_piece(Kernel& kernel, const Part& part, const SolveCall& call,
                                 double known_residual, SolveStats& stats) {
  SolveNext next = SolveNext::kEnd;
  if (call.stage == SolveStage::kBack || call.stage == SolveStage::kLast) kernel.back();
  if (call.stage == SolveStage::kStart) next = kernel.start(stats);
  if (call.stage == SolveStage::kGoOn) next = kernel.apply(SolveNext::kSolve, call.solves, stats);
  if (call.stage == SolveStage::kLast) kernel.apply(SolveNext::kLastSolve, call.solves, stats);
  if (call.stage == SolveStage::kStart || call.stage == SolveStage::kGoOn) {
    if (!stats.converged() || !kernel.forward(call.solves, stats))
      give_up(part, kernel.x, kernel.eq.b, stats);
  } else if (call.stage != SolveStage::kBack) {
    kernel.end(stats);
    if (kernel.x == nullptr) return next;
    if (!find_residuals(part.batch, kernel.x, kernel.eq.b).within(known_residual))
      record_largest(part, kernel.eq.b, stats);
  }
  return next;
}

// For kernels whose guess may have led astray: solves a part that failed once more, from another start. What failed has
// changed nothing but multipliers.
template <template <class> class Kernel, class Batch, class Step>
HWY_NOINLINE void solve_anew(Batch& batch, const Step& step, const Part& part, Scratch scratch,
                             SolveStats& stats) {
  const std::optional<Step> anew = Kernel<AnyShape>::start_anew(batch, step, part);
  if (!anew) return;
  Kernel<AnyShape> kernel(AnyShape(batch.lanes), batch, *anew, part, scratch);
  SolveStats second;
  solve_whole(kernel, part, second);
  if (second.converged()) stats = second;
}

template <template <class> class Kernel, class Shape, class Batch, class Step>
HWY_INLINE void solve_part(const Shape shape, Batch& batch, const Step& step, const Part& part,
                           Scratch scratch, SolveStats& stats) {
  Scratch rows = scratch;
  Kernel<Shape> kernel(shape, batch, step, part, rows);
  solve_whole(kernel, part, stats);
  if constexpr (requires { Kernel<AnyShape>::start_anew(batch, step, part); })
    if (!stats.converged()) solve_anew<Kernel>(batch, step, part, scratch, stats);
}

// Runs the kernel for the groups begin … end − 1 of a batch. For pieces it sets batch.next.
template <template <class> class Kernel, class Batch, class Step>
HWY_INLINE SolveStats solve_groups(Batch& batch, const Step& step, const SolveCall& call, int begin, int end,
                                   const Scratch& scratch) {
  SolveStats all;
  if (call.stage == SolveStage::kWhole) {
    for_each_part(batch.lanes, begin, end, scratch,
                  [&](const auto shape, const Part& part, Scratch rows) HWY_ATTR {
                    SolveStats own{.max_residual = all.max_residual};
                    solve_part<Kernel>(shape, batch, step, part, rows, own);
                    all.beside(own);
                  });
    return all;
  }
  const AnyShape shape(batch.lanes);
  for (int g = begin; g < end; ++g) {
    batch.next[g] = SolveNext::kEnd;
    for (int l = 0; l < batch.lanes.filled(g); l += kWidth) {
      const Part part{batch.lanes, g, l};
      double* const kept = batch.scratch.of(g);
      Scratch rows{kept + l, kept + l + batch.lanes.scratch_rows() * kLanes};
      Kernel<AnyShape> kernel(shape, batch, step, part, rows);
      SolveStats stats;
      const SolveNext next = solve_piece(kernel, part, call, all.max_residual, stats);
      batch.next[g] = HWY_MAX(batch.next[g], next);
      all.beside(stats);
    }
  }
  return all;
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
