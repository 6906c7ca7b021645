#include "tools/proleg/search/adaptation_run.hpp"

#include <cstdio>
#include <exception>
#include <iostream>
#include <utility>

#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/optimize/evaluation/fitness_source.hpp"
#include "sim/optimize/report/report.hpp"
#include "tools/proleg/common/build_id.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/program_run.hpp"

namespace proleg::tools {

using optimize::MadeTrial;

AdaptationRun::AdaptationRun(AdaptationLabels labels, const optimize::Atlas& atlas, const sim::Scenario& intact,
                             std::filesystem::path folder, MadeTrials made)
    : labels_(std::move(labels)),
      atlas_(atlas),
      intact_(intact),
      folder_(std::move(folder)),
      made_(std::move(made)),
      resumed_(made_.all().size()) {}

void AdaptationRun::make_trials(optimize::TrialRobot& robot) {
  try {
    write_table();  // a run can be resumed from its first trial on
    while (std::optional<MadeTrial> trial = made_.next()) {
      const optimize::TrialOutcome outcome = robot.try_gait(made_.gait_of(*trial));
      trial->measured = outcome.score;
      trial->failure = outcome.failure;
      made_.add(*trial);
      write_table();
      if (!labels_.prints_json) {
        std::cout << made_.line_of_last() << std::endl;  // a trial takes seconds: each is shown at once
      }
    }
  } catch (const optimize::SearchFailed& error) {
    failure_ = error.reason();
  } catch (const optimize::SearchEnded&) {
    is_stopped_ = true;
  } catch (const std::exception& error) {
    if (made_.all().empty()) {
      throw;
    }
    failure_ = one_line(error.what());
  }
}

int AdaptationRun::finish() {
  const bool has_best = made_.best() != nullptr;
  try {
    if (has_best) {
      write_adapted();
    }
    if (!made_.all().empty()) {
      write_file(folder_ / files[1], made_.picture());
    }
  } catch (const std::exception& error) {  // the trials are in their table
    failure_ = failure_.value_or(one_line(error.what()));
  }
  if (labels_.prints_json) {
    std::cout << json().text() << '\n';
  } else if (!made_.all().empty()) {
    print();
  }
  if (is_cut_short()) {
    print_how_to_continue();
  } else if (!has_best) {
    std::cerr << "proleg adapt: no trial has a score; the first failure: " << made_.all().front().failure << '\n';
  }
  return has_best && !is_cut_short() ? exit_success : exit_failed;
}

int AdaptationRun::end_before_trials() {
  is_stopped_ = true;
  has_expectations_ = false;
  if (labels_.prints_json) {
    std::cout << json().text() << '\n';
  }
  if (made_.all().empty()) {
    std::cerr << "proleg adapt: interrupted before the first trial\n";
  } else {
    print_how_to_continue();
  }
  return exit_failed;
}

void AdaptationRun::write_table() {
  labels_.comments.diagnosis = made_.all().empty() ? std::string() : made_.text_of_diagnosis();
  write_file(folder_ / files[0], optimize::trial_table(atlas_, labels_.comments, made_.all()));
}

/// The scenario is that of FILE with the gait: damages by options are not in it.
void AdaptationRun::write_adapted() const {
  sim::Scenario adapted = intact_;
  atlas_.experiment.space.apply(made_.gait_of(*made_.best()), adapted);
  optimize::write_scenario(
      adapted,
      "The best gait of " + count_text() + ". Damages and friction of the command line are not in these files.",
      folder_, "adapted");
}

std::string AdaptationRun::count_text() const {
  const std::size_t count = made_.all().size();
  return std::to_string(count) + (count == 1 ? " trial" : " trials");
}

std::string AdaptationRun::ending() const { return failure_ ? "failed" : is_stopped_ ? "interrupted" : made_.ending(); }

void AdaptationRun::print_how_to_continue() const {
  std::cerr << "proleg adapt: "
            << (failure_ ? "ended after " + count_text() + ", because " + *failure_
                         : "interrupted after " + count_text())
            << "; the same command with --resume " << shell_argument(folder_.string()) << " continues\n";
}

void AdaptationRun::print() const {
  if (resumed_ > 0) {
    std::printf("%-10s %zu trials were there already\n", "resumed", resumed_);
  }
  if (made_.best() != nullptr) {
    std::printf("%-10s %s\n", "best", made_.text_of_best().c_str());
  }
  if (const std::string diagnosis = made_.text_of_diagnosis(); !diagnosis.empty()) {
    std::printf("%-10s %s\n", "damage", diagnosis.c_str());
  }
  std::printf("%-10s %s after %s of %s s, engine %s\n", "ended", ending().c_str(), count_text().c_str(),
              number_text(intact_.duration_s).c_str(), labels_.maker.c_str());
  for (const std::string_view file : files) {
    if (std::filesystem::exists(folder_ / file)) {
      std::printf("%-10s %s\n", "written", (folder_ / file).c_str());
    }
  }
}

/// What --json prints.
Json AdaptationRun::json() const {
  Json object = labels_.head;
  made_.add_trials_to(object);
  if (has_expectations_) {
    made_.add_expectations_to(object);
  } else {
    object.add("best_expected", Json());
    object.add("diagnosis", Json());
  }
  object.add("resumed", resumed_);
  object.add("ended", ending());
  object.add("reason", failure_);
  object.add("out", folder_.string());
  object.add("build_id", build_id);
  return object;
}

}  // namespace proleg::tools
