#pragma once

namespace taut {

// Of an option that counts only beside others: whether it does as they are, and where it would. Said all the
// same, it is refused: visit("stiffness", stiffness, "…", Counts{gains == "physical", "with …"}).
struct Counts {
  bool read = true;
  const char* where = "";
};

}  // namespace taut
