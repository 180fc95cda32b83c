#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>

#include "commands.hpp"
#include "md/errors.hpp"
#include "stop_request.hpp"

// Exit codes: 0 done, 1 the simulation failed, 2 the input is wrong, 3 something outside (disk, memory), 128
// + a signal where that one asked to stop.
int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file over the limit is a write that fails
  CLI::App app{
      "taut: molecular dynamics of rigid bonds, by several methods, with what each costs and gets wrong"};
  app.require_subcommand(1);
  std::vector<std::pair<CLI::App*, taut::Action>> actions;
  taut::add_run(app, actions);
  taut::add_resume(app, actions);
  taut::add_calibrate(app, actions);
  taut::add_crosscheck(app, actions);
  taut::add_chart(app, actions);
  taut::add_stability(app, actions);
  taut::add_lists(app, actions);
  try {
    app.parse(argc, argv);
    for (const auto& [subcommand, act] : actions)
      if (subcommand->parsed()) act();
    return 0;
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  } catch (const taut::Stopped& stopped) {
    return stopped.exit_code;
  } catch (const taut::SimulationFailure& e) {
    fmt::print(stderr, "taut: the simulation failed: {}\n", e.what());
    return 1;
  } catch (const taut::InputError& e) {
    fmt::print(stderr, "taut: {}\n", e.what());
    return 2;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "taut: out of memory\n");
    return 3;
  } catch (const std::exception& e) {
    fmt::print(stderr, "taut: {}\n", e.what());
    return 3;
  }
}
