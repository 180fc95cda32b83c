#pragma once

#include <array>
#include <string>
#include <vector>

namespace taut {

// A function by its values at equal spacing h, joined by the natural cubic spline, as OpenMM's
// Continuous1DFunction joins them: between two points
//     E = a + b t + c t² + d t³,   0 ≤ t ≤ 1,
// with continuous first and second derivatives, the second one zero at both ends. Where the function is smooth,
// values are right to h⁴ and slopes to h³ (de Boor 1978, A Practical Guide to Splines); within a few points of an
// end at which its second derivative is not zero, to h² and h.
class Spline {
 public:
  // `name` is for messages. Throws InputError for fewer than three values, one that is not finite, or last ≤ first.
  Spline(std::string name, double first, double last, std::vector<double> values);

  struct Value {
    double value, slope;
  };
  // For first ≤ x ≤ last.
  Value at(double x) const;
  bool covers(double x) const {  // rounding aside
    const double slack = 1e-9 * spacing_;
    return x >= first_ - slack && x <= last_ + slack;
  }

  const std::string& name() const { return name_; }
  double first() const { return first_; }
  double last() const { return last_; }
  double spacing() const { return spacing_; }
  const std::vector<double>& values() const { return values_; }
  double place_of_least() const;  // the point of the least value

  using Interval = std::array<double, 4>;  // a, b, c, d
  const std::vector<Interval>& intervals() const { return intervals_; }

 private:
  std::string name_;
  double first_, last_, spacing_;
  std::vector<double> values_;
  std::vector<Interval> intervals_;
};

}  // namespace taut
