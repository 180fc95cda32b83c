#pragma once

namespace taut {

// nm, ps, u, kJ/mol, K, e: consistent, 1 u·nm²/ps² = 1 kJ/mol. The digits agree with OpenMM 7.7.
inline constexpr double kBoltzmann = 0.00831446261815324;  // [kJ/mol/K]
inline constexpr double kCoulomb = 138.93545764438198;     // 1/(4πε₀) [kJ/mol·nm/e²]
inline constexpr double kBarPerUnit = 16.6053906717;       // 1 kJ/mol/nm³ [bar]
inline constexpr double kDensityPerUnit = 1.66053906717;   // 1 u/nm³ [kg/m³]

}  // namespace taut
