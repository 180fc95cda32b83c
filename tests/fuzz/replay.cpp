// Runs a harness over its corpus and over seeded changes to it: <harness> <folder> <changes>. What it was
// at when it fell is left in a file.

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <string_view>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

namespace fs = std::filesystem;

std::string now;  // what the harness is at

void run(std::string input) {
  now = std::move(input);
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(now.data()), now.size());
}

[[noreturn]] void fall() {
  std::ofstream("fuzz_fell.input", std::ios::binary) << now;
  std::fprintf(stderr, "fell over the input left in %s\n", fs::absolute("fuzz_fell.input").c_str());
  if (const auto current = std::current_exception()) try {
      std::rethrow_exception(current);
    } catch (const std::exception& e) {
      std::fprintf(stderr, "thrown: %s\n", e.what());
    }
  std::abort();
}

class Changes {
 public:
  explicit Changes(std::vector<std::string> corpus) : corpus_(std::move(corpus)) {}

  std::string next() {
    std::string text = pick(corpus_);
    for (std::size_t n = below(4) + 1; n > 0; --n) change(text);
    return text;
  }

 private:
  void change(std::string& text) {
    static const std::vector<std::string> kWords = {
        "0", "-1", "1e12", "1e-300", "9223372036854775807", "nan", "inf", "\"\"", "[", "]", "\n", "="};
    const std::size_t at = below(text.size() + 1),
                      length = below(std::min<std::size_t>(40, text.size() - at) + 1);
    switch (below(5)) {
      case 0:
        text.erase(at, length);
        break;
      case 1:
        text.insert(at, text.substr(below(text.size() + 1), length));
        break;
      case 2:
        if (at < text.size()) text[at] = static_cast<char>(below(256));
        break;
      case 3:  // another number
        if (const auto digit = text.find_first_of("0123456789", at); digit != text.npos) {
          const auto end = std::min(text.find_first_not_of("0123456789.e-+", digit), text.size());
          text.replace(digit, end - digit, pick(kWords));
        }
        break;
      default:
        text.insert(at, pick(kWords));
    }
  }

  std::size_t below(std::size_t n) { return n == 0 ? 0 : engine_() % n; }
  const std::string& pick(const std::vector<std::string>& from) { return from[below(from.size())]; }

  std::vector<std::string> corpus_;
  std::mt19937_64 engine_{1};
};

}  // namespace

int main(int count, char** words) {
  if (count != 3) return 2;
  std::set_terminate(fall);
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(words[1])) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<std::string> corpus;
  for (const auto& file : files) {
    std::ifstream in(file, std::ios::binary);
    corpus.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
    run(corpus.back());
  }
  if (corpus.empty()) return 2;
  Changes changes(corpus);
  const long wanted = std::atol(words[2]);
  for (long n = 0; n < wanted; ++n) run(changes.next());
  std::printf("%zu inputs and %ld changes of them: all taken or refused in a line\n", corpus.size(), wanted);
}
