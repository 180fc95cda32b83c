#pragma once

#include <string>
#include <vector>

#include "studies/calibration.hpp"
#include "studies/repeats.hpp"

namespace taut {

// A method beside others in runs from one start, of which each takes a few steps in turn, so that all meet the same
// machine. A quarter of the steps more go before those that are measured.
struct ComparedMethod {
  std::string method;                // in a word, "rattle:sweeps=4"
  std::string role;                  // "as calibrated"
  Calibration::Reduction reduction;  // of an error of the bond lengths, a step
  Trial trial;
  Quartiles ns_per_bond;            // of the bonds' time a step, over the turns [ns]
  std::vector<std::string> doubts;  // that `taut run` has after as many steps, and has not with newton

  // Got through, is at rest, undoubted, and neither its bonds nor all together heat (Trial::keeps_energy).
  bool sound() const;
};

// Takes out the doubts that the last method has, too, and returns those: they are about the scene, whoever holds its
// bonds. Two are alike if their words are, up to the first number.
std::vector<std::string> take_out_common_doubts(std::vector<ComparedMethod>& compared);

// What was calibrated beside its reference, Baumgarte's default and newton.
std::vector<ComparedMethod> compare_methods(const Scene& scene, const CalibrationPlan& plan,
                                            const Calibration& c);

// The one to take: of the sound ones whose times the quartiles do not tell from the cheapest's the calibrated one, or
// else the first; none where none is sound.
const ComparedMethod* best_of(const std::vector<ComparedMethod>& compared);

// Which to take and why, in a sentence with the widths of its errors; `step_fs` is the scene's.
std::string verdict_of(const std::vector<ComparedMethod>& compared, double step_fs);

// The columns of its table by name, a row each.
std::string compared_csv(const std::vector<ComparedMethod>& compared);

}  // namespace taut
