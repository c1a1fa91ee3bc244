#include <lefort/app/commands/deprecated_options.h>
#include <lefort/io/deprecated_keys.h>

#include <fmt/format.h>

#include <sstream>
#include <string>

namespace lefort::app {

void add_deprecated_options(CLI::App& cli) {
  for (const io::DeprecatedOption& name : io::deprecated_options()) {
    CLI::App* command = &cli;
    std::istringstream words{std::string(name.command)};
    for (std::string word; words >> word;) command = command->get_subcommand(word);
    CLI::Option* const option = command->get_option(std::string(name.new_option));
    const auto forward = [option, name](const CLI::results_t& values) {
      if (option->count() > 0)
        throw CLI::ExcludesError(std::string(name.old_option), std::string(name.new_option));
      fmt::print(stderr, "warning: {} is deprecated, use {}\n", name.old_option, name.new_option);
      for (const std::string& value : values) option->add_result(value);
      option->run_callback();
      return true;
    };
    command->add_option(std::string(name.old_option), forward)
        ->group("")
        ->type_size(option->get_type_size_min(), option->get_type_size_max())
        ->expected(option->get_expected_min(), option->get_expected_max())
        ->allow_extra_args(option->get_allow_extra_args());
  }
}

}  // namespace lefort::app
