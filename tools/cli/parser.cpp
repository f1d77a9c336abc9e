// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/parser.hpp"

#include <CLI/CLI.hpp>

namespace jink::tools::cli {

Option& Option::required() {
  option_->required();
  return *this;
}

Option& Option::check(const Validator& validator) {
  option_->check(CLI::Validator(validator, ""));
  return *this;
}

Option& Option::transform(const Validator& validator) {
  option_->transform(CLI::Validator(validator, ""));
  return *this;
}

Option& Option::one_of(const std::vector<std::string>& values) {
  option_->check(CLI::IsMember(values));
  return *this;
}

Option& Option::expected(int least, int most) {
  option_->expected(least, most);
  return *this;
}

Option& Option::single_value() {
  option_->allow_extra_args(false);
  return *this;
}

Option& Option::show_default() {
  option_->capture_default_str();
  return *this;
}

Option& Option::describe(const std::string& what) {
  option_->description(what);
  return *this;
}

Option& Option::excludes(const Option& other) {
  option_->excludes(other.option_);
  return *this;
}

Parser Parser::add_subcommand(const std::string& name, const std::string& what) const {
  return Parser(app_->add_subcommand(name, what));
}

Option Parser::add_option(const std::string& name, std::string& value, const std::string& what) const {
  return Option(app_->add_option(name, value, what));
}

Option Parser::add_option(const std::string& name, std::vector<std::string>& values, const std::string& what) const {
  return Option(app_->add_option(name, values, what));
}

Option Parser::add_option(const std::string& name, int& value, const std::string& what) const {
  return Option(app_->add_option(name, value, what));
}

Option Parser::add_option(const std::string& name, std::uint64_t& value, const std::string& what) const {
  return Option(app_->add_option(name, value, what));
}

Option Parser::add_option(const std::string& name, double& value, const std::string& what) const {
  return Option(app_->add_option(name, value, what));
}

Option Parser::add_option(const std::string& name, std::optional<int>& value, const std::string& what) const {
  return Option(app_->add_option(name, value, what));
}

Option Parser::add_option(const std::string& name, std::optional<double>& value, const std::string& what) const {
  return Option(app_->add_option(name, value, what));
}

Option Parser::add_flag(const std::string& name, bool& value, const std::string& what) const {
  return Option(app_->add_flag(name, value, what));
}

Option Parser::option(const std::string& name) const {
  return Option(app_->get_option(name));
}

void Parser::footer(const std::string& text) const {
  app_->footer(text);
}

std::size_t Parser::count(const std::string& name) const {
  return app_->count(name);
}

std::string Parser::name() const {
  return app_->get_name();
}

bool Parser::parsed() const {
  return app_->parsed();
}

}  // namespace jink::tools::cli
