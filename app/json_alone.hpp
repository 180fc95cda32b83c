#pragma once

#include <string>

namespace taut {

// Where JSON is asked for, nothing else is printed while it lives.
class JsonAlone {
 public:
  explicit JsonAlone(bool asked);
  JsonAlone(const JsonAlone&) = delete;
  JsonAlone& operator=(const JsonAlone&) = delete;
  ~JsonAlone();

  void print(const std::string& json);  // nothing where it is not asked for

 private:
  void print_again();

  int stdout_ = -1;  // where it went
};

}  // namespace taut
