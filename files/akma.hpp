#pragma once

namespace taut {

inline constexpr double kAkma = 0.04888821;  // √(u·Å²/(kcal/mol)), CHARMM's unit of time [ps]

}  // namespace taut
