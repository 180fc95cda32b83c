#include "systems/openmm/expression.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>
#include <vector>

#include "base/random.hpp"

namespace taut {
namespace {

using Values = Expression::Values;
using Arguments = std::span<const double>;

// The distance between nearest images, in a cube of edge 1. Expressions are only compared with each other, at
// coordinates between -1 and 1, where a cube of this edge tells a periodic from a plain distance.
double periodic_distance(Arguments a) {
  constexpr double kEdge = 1;
  double square = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double d = a[c] - a[c + 3];
    square += std::pow(d - kEdge * std::round(d / kEdge), 2);
  }
  return std::sqrt(square);
}

// The functions of OpenMM's expressions.
const Expression::Tables& own_functions() {
  static const Expression::Tables kAll = [] {
    Expression::Tables all;
    const auto one = [&](const char* name, double (*f)(double)) {
      all[name] = {1, [f](Arguments a) { return f(a[0]); }};
    };
    const auto two = [&](const char* name, double (*f)(double, double)) {
      all[name] = {2, [f](Arguments a) { return f(a[0], a[1]); }};
    };
    one("sqrt", [](double x) { return std::sqrt(x); });
    one("exp", [](double x) { return std::exp(x); });
    one("log", [](double x) { return std::log(x); });
    one("sin", [](double x) { return std::sin(x); });
    one("cos", [](double x) { return std::cos(x); });
    one("tan", [](double x) { return std::tan(x); });
    one("asin", [](double x) { return std::asin(x); });
    one("acos", [](double x) { return std::acos(x); });
    one("atan", [](double x) { return std::atan(x); });
    one("sinh", [](double x) { return std::sinh(x); });
    one("cosh", [](double x) { return std::cosh(x); });
    one("tanh", [](double x) { return std::tanh(x); });
    one("erf", [](double x) { return std::erf(x); });
    one("erfc", [](double x) { return std::erfc(x); });
    one("abs", [](double x) { return std::abs(x); });
    one("floor", [](double x) { return std::floor(x); });
    one("ceil", [](double x) { return std::ceil(x); });
    one("square", [](double x) { return x * x; });
    one("cube", [](double x) { return x * x * x; });
    one("recip", [](double x) { return 1 / x; });
    one("step", [](double x) { return x >= 0 ? 1.0 : 0.0; });
    one("delta", [](double x) { return x == 0 ? 1.0 : 0.0; });
    two("atan2", [](double x, double y) { return std::atan2(x, y); });
    two("min", [](double x, double y) { return std::min(x, y); });
    two("max", [](double x, double y) { return std::max(x, y); });
    all["periodicdistance"] = {6, periodic_distance};
    all["select"] = {3, [](Arguments a) { return a[0] != 0 ? a[1] : a[2]; }};
    return all;
  }();
  return kAll;
}

}  // namespace

// A recursive descent parser. Precedence rises from + and - over * and / and the sign to ^, which associates
// to the right.
class ExpressionParser {
 public:
  ExpressionParser(Expression& to, const Expression::Tables& tables, Expression::Numbers named)
      : to_(to), tables_(tables), named_(named) {}

  // Reads definitions from the last to the first, then the energy.
  void parse(std::string_view text) {
    if (text.size() > kLongest) throw Expression::Error("is too long");
    while (!text.empty() && (std::isspace(static_cast<unsigned char>(text.back())) || text.back() == ';'))
      text.remove_suffix(1);
    for (;;) {
      const auto cut = text.rfind(';');
      text_ = cut == text.npos ? text : text.substr(cut + 1);
      if (cut == text.npos) break;
      const std::string name = identifier();
      expect('=');
      Node value = whole_sum();
      if (!definitions_.emplace(name, std::move(value)).second)
        throw Expression::Error(fmt::format("defines {} twice", name));
      text = text.substr(0, cut);
    }
    const Node energy = whole_sum();
    to_.value_ = *energy.value;
    to_.names_ = energy.names;
  }

 private:
  using Value = std::function<double(const Values&)>;
  // A part of an expression. A definition is shared by all parts that name it; `work` counts its nodes once
  // for each use, which bounds the time of an evaluation.
  struct Node {
    std::shared_ptr<const Value> value;
    std::set<std::string> names;
    long work = 1;
  };
  static constexpr std::size_t kLongest = 4000;  // characters
  static constexpr long kMostWork = 4000;
  static constexpr int kDeepest = 100;

  Node node(Value value, std::initializer_list<const Node*> of) {
    Node made{std::make_shared<const Value>(std::move(value)), {}, 1};
    for (const Node* part : of) add(made, *part);
    return made;
  }

  static void add(Node& to, const Node& part) {
    to.names.insert(part.names.begin(), part.names.end());
    to.work += part.work;
    if (to.work > kMostWork) throw Expression::Error("is too long");
  }

  template <class Operator>
  Node joined(const Node& a, const Node& b, Operator op) {
    return node([a = a.value, b = b.value, op](const Values& v) { return op((*a)(v), (*b)(v)); }, {&a, &b});
  }

  Node whole_sum() {
    Node value = sum();
    if (peek() != '\0') fail("an operator");
    return value;
  }

  Node sum() {
    if (++depth_ > kDeepest) throw Expression::Error("is nested too deep");
    Node value = product();
    for (;;) {
      if (accept('+'))
        value = joined(value, product(), std::plus<>());
      else if (accept('-'))
        value = joined(value, product(), std::minus<>());
      else
        break;
    }
    --depth_;
    return value;
  }

  Node product() {
    Node value = with_sign();
    for (;;) {
      if (accept('*'))
        value = joined(value, with_sign(), std::multiplies<>());
      else if (accept('/'))
        value = joined(value, with_sign(), std::divides<>());
      else
        return value;
    }
  }

  Node with_sign() {
    bool minus = false;
    while (peek() == '-' || peek() == '+') minus ^= take() == '-';
    if (const auto after = text_; minus && std::isdigit(static_cast<unsigned char>(peek()))) {
      Node value = number(-1);  // a name of its own
      if (peek() != '^') return value;
      text_ = after;
    }
    const Node value = power();
    return minus ? node([a = value.value](const Values& v) { return -(*a)(v); }, {&value}) : value;
  }

  Node power() {
    const Node base = atom();
    if (!accept('^')) return base;
    if (++depth_ > kDeepest) throw Expression::Error("is nested too deep");
    const Node exponent = with_sign();
    --depth_;
    return joined(base, exponent, [](double a, double b) { return std::pow(a, b); });
  }

  Node atom() {
    if (accept('(')) {
      Node value = sum();
      expect(')');
      return value;
    }
    const char c = peek();
    if (std::isdigit(static_cast<unsigned char>(c)) || c == '.') return number();
    const std::string name = identifier();
    if (accept('(')) return call(name);
    if (const auto known = definitions_.find(name); known != definitions_.end()) return known->second;
    return variable(name);
  }

  Node variable(const std::string& name) {
    Node value = node([name](const Values& v) { return v.at(name); }, {});
    value.names.insert(name);
    return value;
  }

  Node number(int sign = 1) {
    double value = 0;
    const auto [end, error] = std::from_chars(text_.data(), text_.data() + text_.size(), value);
    if (error != std::errc()) fail("a number");
    text_.remove_prefix(static_cast<std::size_t>(end - text_.data()));
    value *= sign;
    if (named_ == Expression::Numbers::kFixed) return node([value](const Values&) { return value; }, {});
    std::string name = fmt::format("{}", value);  // no name that a text has
    if (named_ == Expression::Numbers::kNamedApart) name += fmt::format("@{}", to_.numbers_.size());
    to_.numbers_[name] = value;
    return variable(name);
  }

  Node call(const std::string& name) {
    std::vector<Node> arguments;
    do arguments.push_back(sum());
    while (accept(','));
    expect(')');
    const auto own = own_functions().find(name), table = tables_.find(name);
    if (own == own_functions().end() && table == tables_.end())
      throw Expression::Error(fmt::format("calls {}, which is no function of it", name));
    const Expression::Table& function = table == tables_.end() ? own->second : table->second;
    if (std::ssize(arguments) != function.arguments)
      throw Expression::Error(
          fmt::format("calls {} of {} arguments with {}", name, function.arguments, arguments.size()));
    std::vector<std::shared_ptr<const Value>> values;
    for (const Node& a : arguments) values.push_back(a.value);
    Node made = node(
        [values, f = function.value](const Values& v) {
          double x[6] = {};
          for (std::size_t k = 0; k < values.size(); ++k) x[k] = (*values[k])(v);
          return f(Arguments(x, values.size()));
        },
        {});
    for (const Node& a : arguments) add(made, a);
    return made;
  }

  std::string identifier() {
    peek();
    std::size_t length = 0;
    while (length < text_.size() &&
           (std::isalnum(static_cast<unsigned char>(text_[length])) || text_[length] == '_'))
      ++length;
    if (length == 0 || std::isdigit(static_cast<unsigned char>(text_[0]))) fail("a name");
    const std::string name(text_.substr(0, length));
    text_.remove_prefix(length);
    return name;
  }

  char peek() {
    while (!text_.empty() && std::isspace(static_cast<unsigned char>(text_.front()))) text_.remove_prefix(1);
    return text_.empty() ? '\0' : text_.front();
  }
  char take() {
    const char c = peek();
    text_.remove_prefix(1);
    return c;
  }
  bool accept(char c) {
    if (peek() != c) return false;
    take();
    return true;
  }
  void expect(char c) {
    if (!accept(c)) fail(std::string(1, c));
  }
  [[noreturn]] void fail(const std::string& expected) {
    throw Expression::Error(fmt::format("expected {}, found \"{}\"", expected,
                                        text_.substr(0, std::min<std::size_t>(20, text_.size()))));
  }

  Expression& to_;
  const Expression::Tables& tables_;
  Expression::Numbers named_;
  std::string_view text_;
  std::map<std::string, Node> definitions_;
  int depth_ = 0;
};

Expression::Expression(std::string_view text, const Tables& tables, Numbers named) {
  ExpressionParser(*this, tables, named).parse(text);
}

namespace {

constexpr int kPoints = 24;
constexpr std::size_t kMostDeclared = 8;  // with more parameters than this, only equal names are tried
constexpr double kTolerance = 3e-5;       // openmm.app writes π as 3.141593 in places
constexpr double kSmallEnergy = 0.1;      // below it the difference counts, not the relative difference

}  // namespace

std::optional<Recognized> recognize(const Expression& energy, std::vector<std::string> declared,
                                    const std::vector<Quantity>& coordinates, const KnownEnergy& known) {
  struct Point {
    Expression::Values known, given;  // arguments of the known and of the given energy
  };
  std::array<Point, kPoints> points;
  Random random(1);
  const auto draw = [&](const Quantity& q) { return q.low + (q.high - q.low) * random.uniform(); };
  for (Point& point : points) {
    for (const auto& name : declared) point.given[name] = draw({"", 0.5, 1.5});
    point.given.insert(energy.numbers().begin(), energy.numbers().end());
    for (const Quantity& q : known.parameters) point.known[q.name] = draw(q);
    for (const Quantity& q : known.within.empty() ? coordinates : known.within)
      point.given[q.name] = point.known[q.name] = draw(q);
  }

  for (const auto& name : energy.names())
    if (!points[0].given.contains(name)) return {};  // a parameter of each atom of a pair
  for (const auto& [name, value] : energy.numbers()) declared.push_back(name);

  // The given energy in units of the known one, where names[k] stands for the k-th known parameter.
  const Expression known_energy(known.text);
  const std::size_t n = known.parameters.size();
  const auto compare = [&](const std::vector<std::string>& names) -> std::optional<Recognized> {
    Recognized found{0, {}};
    for (std::size_t k = 0; k < n; ++k) found.name_of[known.parameters[k].name] = names[k];
    std::array<double, kPoints> value, other;
    std::vector<double> ratio;  // of points where there is an energy
    for (int p = 0; p < kPoints; ++p) {
      Expression::Values given = points[p].given;
      for (const auto& [name, its_name] : found.name_of) given[its_name] = points[p].known[name];
      value[p] = known_energy(points[p].known);
      other[p] = energy(given);
      if (value[p] == 0) continue;  // as both are beyond a wall: is compared below
      ratio.push_back(other[p] / value[p]);
      if (!std::isfinite(ratio.back()) || ratio.back() == 0) return {};
    }
    if (ratio.size() < kPoints / 4) return {};
    const auto middle = ratio.begin() + std::ssize(ratio) / 2;
    std::ranges::nth_element(ratio, middle);
    found.factor = *middle;
    for (int p = 0; p < kPoints; ++p)
      if (!(std::abs(other[p] / found.factor - value[p]) <= kTolerance * (std::abs(value[p]) + kSmallEnergy)))
        return {};
    return found;
  };

  std::vector<std::string> names;
  for (const Quantity& q : known.parameters) names.emplace_back(q.name);
  if (std::ranges::all_of(names, [&](const auto& name) { return std::ranges::count(declared, name) > 0; }))
    if (auto found = compare(names)) return found;
  if (declared.size() > kMostDeclared || declared.size() < n) return {};
  // Every choice of n names in every order. Reversing the rest skips the orders that differ in it alone.
  names = declared;
  std::ranges::sort(names);
  do {
    if (auto found = compare(names)) return found;
    std::reverse(names.begin() + static_cast<std::ptrdiff_t>(n), names.end());
  } while (std::next_permutation(names.begin(), names.end()));
  return {};
}

}  // namespace taut
