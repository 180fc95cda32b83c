#pragma once

#include "pictures.hpp"
#include "studies/stability_study.hpp"

namespace taut {

Picture plane_picture(const StabilityPlan& plan, const Ledger& ledger);
Picture steps_picture(const StabilityPlan& plan, const Ledger& ledger);

}  // namespace taut
