#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace taut {

// An energy in the language of OpenMM's custom forces, "k*(r-r0)^2; r0=0.5*(a1+a2)": numbers, names, + - * /
// ^ and functions; definitions follow the energy after semicolons, each valid in the parts before it.
class Expression {
 public:
  using Values = std::map<std::string, double, std::less<>>;
  using Function = std::function<double(std::span<const double>)>;
  struct Table {
    int arguments;
    Function value;
  };
  using Tables = std::map<std::string, Table, std::less<>>;
  struct Error : std::runtime_error {  // "expected ), found ..."
    using runtime_error::runtime_error;
  };

  // Whether its numbers are variables, too: none, equal ones by one name, or each by its own.
  enum class Numbers { kFixed, kNamedAlike, kNamedApart };

  // Throws Error for a text that is no expression. `tables` are tabulated functions that it may call.
  explicit Expression(std::string_view text, const Tables& tables = {}, Numbers named = Numbers::kFixed);

  const std::set<std::string>& names() const { return names_; }  // its variables
  const Values& numbers() const { return numbers_; }             // those of them that are numbers of the text
  double operator()(const Values& values) const { return value_(values); }

 private:
  friend class ExpressionParser;
  std::function<double(const Values&)> value_;
  std::set<std::string> names_;
  Values numbers_;
};

// A parameter or coordinate of an energy, and the range in which energies are compared. The range reaches to
// both sides of the point at which a similar energy is cut off (a spring that only pulls, a Lennard-Jones
// potential that only repels).
struct Quantity {
  const char* name;
  double low = 0.5, high = 1.5;
};

// An energy function that taut computes. A custom force is recognized where its energy is a constant multiple
// of this function, however its formula is written and whatever its parameters are called.
struct KnownEnergy {
  const char* text;
  std::vector<Quantity> parameters;
  std::vector<Quantity> within = {};  // ranges of the coordinates, if not the force's own
};

// The given energy is `factor` times the known one, with parameters renamed.
struct Recognized {
  double factor;
  std::map<std::string, std::string> name_of;  // from a known parameter to the given energy's
};

// Compares an energy with a known one at 24 points: users write one formula in too many ways for a table of
// normal forms (min, step and floor for the period of an angle, powers multiplied out, definitions).
// `declared` lists the parameters that may stand for the known ones, beside the energy's named numbers.
std::optional<Recognized> recognize(const Expression& energy, std::vector<std::string> declared,
                                    const std::vector<Quantity>& coordinates, const KnownEnergy& known);

// Formulas that are exported where OpenMM has no class for a term.
constexpr const char* kGravityEnergy = "-mass*(gx*x+gy*y+gz*z)";  // gx, gy, gz are global
constexpr const char* kPullEnergy = "-(fx*x+fy*y+fz*z)";
constexpr const char* kRestraintEnergy = "0.5*k*periodicdistance(x,y,z,x0,y0,z0)^2";
constexpr const char* kRestraintWithoutBox = "0.5*k*((x-x0)^2+(y-y0)^2+(z-z0)^2)";
// Walls across x, y and z. `faces` is 1 or −1; `shift` is the energy at the cutoff, where step() ends it.
inline constexpr std::array kWallEnergy = {
    "step(cut-d)*(eps*(2/15*(sig/d)^9-(sig/d)^3)-shift); d=faces*(x-at)",
    "step(cut-d)*(eps*(2/15*(sig/d)^9-(sig/d)^3)-shift); d=faces*(y-at)",
    "step(cut-d)*(eps*(2/15*(sig/d)^9-(sig/d)^3)-shift); d=faces*(z-at)"};
constexpr const char* kFeneEnergy = "-0.5*k*r0^2*log(1-(r/r0)^2)";
// Parameters are global; the force is cut off at 2^(1/6)σ.
constexpr const char* kWcaEnergy = "4*epsilon*((sigma/r)^12-(sigma/r)^6)+epsilon";
constexpr const char* kLennardJonesEnergy = "a(type1,type2)/r^12-b(type1,type2)/r^6";
constexpr const char* kCosineAngleEnergy = "k*(1+cos(theta))";
constexpr const char* kCosineSquaredEnergy = "0.5*k*(cos(theta)-c0)^2";
constexpr const char* kTableOfDistance = "table(distance(p1,p2))";
constexpr const char* kTableOfAngle = "table(angle(p1,p2,p3))";
constexpr const char* kTorsionEnergy =
    "0.5*k*min(turn,2*pi-turn)^2;turn=abs(theta-theta0);pi=3.141592653589793";

}  // namespace taut
