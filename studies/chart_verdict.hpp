#pragma once

#include <string>
#include <vector>

namespace taut {

// What a chart says in words, a line each, of the tables work.csv and drift.csv: the cheapest settings below three
// errors of the bonds, those that keep the energy at this step [fs], and which to take: the cheapest that does both.
// A setting keeps the energy where its drift's 95 % interval holds zero. Of settings whose quartiles overlap with the
// cheapest one's, those of other methods are named too.
std::vector<std::string> chart_verdict(const std::string& work_csv, const std::string& drift_csv,
                                       double dt_fs);

// Says that times are noise where the machine's load of the last minute leaves less than half a core free; else "".
std::string warn_of_load(double load, long cores);

}  // namespace taut
