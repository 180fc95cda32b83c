#pragma once

#include "pictures.hpp"
#include "studies/chart_study.hpp"

namespace taut {

struct CaptionedPicture {
  Picture picture;
  std::string title, caption;
};

// The four panels of a finished study.
std::vector<CaptionedPicture> chart_pictures(const ChartPlan& plan, const Ledger& ledger);

}  // namespace taut
