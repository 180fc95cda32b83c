#include "systems/openmm/expression.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "systems/openmm/expression_functions.hpp"

namespace taut {
namespace {

using namespace rough;
using Values = Expression::Values;
using Ways = Expression::Ways;

double pi_if_meant(double number) {
  for (const double pi : {std::numbers::pi, 2 * std::numbers::pi})
    if (std::abs(number - pi) < 1e-6 * pi) return pi;
  return number;
}

}  // namespace

bool Expression::Rough::decided() const {
  return error < kUnknown || !std::isfinite(value);
}

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
  using Value = std::function<Rough(const Values&, Ways*)>;
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
    return node(
        [a = a.value, b = b.value, op](const Values& v, Ways* w) { return op((*a)(v, w), (*b)(v, w)); },
        {&a, &b});
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
        value = joined(value, product(),
                       [](Rough a, Rough b) { return rounded(a.value + b.value, a.error + b.error); });
      else if (accept('-'))
        value = joined(value, product(),
                       [](Rough a, Rough b) { return rounded(a.value - b.value, a.error + b.error); });
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
        value = joined(value, with_sign(), [](Rough a, Rough b) {
          return rounded(a.value * b.value, std::abs(a.value) * b.error + std::abs(b.value) * a.error);
        });
      else if (accept('/'))
        value = joined(value, with_sign(), [](Rough a, Rough b) {
          const double y = a.value / b.value;
          if (b.error > 0 && std::abs(b.value) <= b.error) return Rough{y, kUnknown};
          return rounded(y, (a.error + std::abs(y) * b.error) / std::abs(b.value));
        });
      else
        return value;
    }
  }

  Node with_sign() {
    bool minus = false;
    while (peek() == '-' || peek() == '+') minus ^= take() == '-';
    if (const auto after = text_; minus && std::isdigit(static_cast<unsigned char>(peek()))) {
      Node value = read_number(-1);  // a name of its own
      if (peek() != '^') return value;
      text_ = after;
    }
    const Node value = power();
    if (!minus) return value;
    return node(
        [a = value.value](const Values& v, Ways* w) {
          const Rough x = (*a)(v, w);
          return Rough{-x.value, x.error};
        },
        {&value});
  }

  Node power() {
    const Node base = atom();
    if (!accept('^')) return base;
    if (++depth_ > kDeepest) throw Expression::Error("is nested too deep");
    const Node exponent = with_sign();
    --depth_;
    return joined(base, exponent, [](Rough a, Rough b) {
      const std::array both{a, b};
      return smooth([](std::span<const double> x) { return std::pow(x[0], x[1]); }, both);
    });
  }

  Node atom() {
    if (accept('(')) {
      Node value = sum();
      expect(')');
      return value;
    }
    const char c = peek();
    if (std::isdigit(static_cast<unsigned char>(c)) || c == '.') return read_number();
    const std::string name = identifier();
    if (accept('(')) return call(name);
    if (const auto known = definitions_.find(name); known != definitions_.end()) return known->second;
    return variable(name);
  }

  Node variable(const std::string& name) {
    Node value = node([name](const Values& v, Ways*) { return Rough{v.at(name)}; }, {});
    value.names.insert(name);
    return value;
  }

  Node read_number(int sign = 1) {
    double value = 0;
    const auto [end, error] = std::from_chars(text_.data(), text_.data() + text_.size(), value);
    if (error != std::errc()) fail("a number");
    text_.remove_prefix(static_cast<std::size_t>(end - text_.data()));
    value = sign * pi_if_meant(value);
    to_.literals_.push_back(value);
    if (named_ == Expression::Numbers::kFixed)
      return node([value](const Values&, Ways*) { return Rough{value}; }, {});
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
    if (const auto table = tables_.find(name); table != tables_.end())
      return call(name, table->second.arguments, arguments, table->second.value);
    if (const auto own = smooth_functions().find(name); own != smooth_functions().end())
      return call(name, own->second.arguments, arguments, own->second.value);
    const auto branch = branching_functions().find(name);
    if (branch == branching_functions().end())
      throw Expression::Error(fmt::format("calls {}, which is no function of it", name));
    std::set<std::string>& names = to_.branches_.emplace_back();
    for (const Node& a : arguments) names.insert(a.names.begin(), a.names.end());
    return call(name, branch->second.arguments, arguments,
                Turning{branch->second.value, to_.branches_.size() - 1});
  }

  // A branch, whose way is kept at its place among all.
  struct Turning {
    Rough (*function)(Arguments, int& way);
    std::size_t place;
  };
  static Rough value_of(const Turning& f, Arguments x, Ways* ways) {
    int way = 0;
    const Rough y = f.function(x, way);
    if (ways) (*ways)[f.place] = way;
    return y;
  }
  template <class Function>
  static Rough value_of(const Function& f, Arguments x, Ways*) {
    return smooth(f, x);
  }

  template <class Function>
  Node call(const std::string& name, int expected, const std::vector<Node>& arguments, const Function& f) {
    if (std::ssize(arguments) != expected)
      throw Expression::Error(
          fmt::format("calls {} of {} arguments with {}", name, expected, arguments.size()));
    std::vector<std::shared_ptr<const Value>> values;
    for (const Node& a : arguments) values.push_back(a.value);
    Node made = node(
        [values, f](const Values& v, Ways* w) {
          std::array<Rough, kMostArguments> x;
          for (std::size_t k = 0; k < values.size(); ++k) x[k] = (*values[k])(v, w);
          return value_of(f, Arguments(x.data(), values.size()), w);
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

Expression::Rough Expression::probe(const Values& values, Ways& ways) const {
  ways.assign(branches_.size(), kUndecided);
  return value_(values, &ways);
}

}  // namespace taut
