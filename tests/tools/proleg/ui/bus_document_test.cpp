#include "tools/proleg/ui/bus_view.hpp"

#include <gtest/gtest.h>

#include "shared/canopen/messages.hpp"
#include "shipped.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

class BusDocumentTest : public ::testing::Test {
 protected:
  BusDocumentTest() {
    view.address = "can0";
    view.is_connected = true;
    view.now = 10'000'000;
    view.seconds = 0.5;
    view.traffic = {50, 400, 0.1};
    node.node = 4;
    node.state = canopen::NmtState::operational;
    node.last_heard = view.now;
  }
  json module() {
    view.nodes = {node};
    return bus_document(scenario.modules, view)["modules"][0];
  }

  sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  BusView view;
  host::MonitoredNode node;
};

TEST_F(BusDocumentTest, NamesTheJointOfAModuleAndNoneForAForeignNode) {
  EXPECT_EQ(module()["joint"], 3);
  node.node = 99;
  EXPECT_TRUE(module()["joint"].is_null());
}

TEST_F(BusDocumentTest, WhatIsNotKnownIsNull) {
  node.state = std::nullopt;
  for (const char* name :
       {"state", "drive", "angle", "current", "current_limit", "temperature", "fault", "advice", "stop_confirmed"}) {
    EXPECT_TRUE(module()[name].is_null()) << name;
  }
  node.current_ma = 350;
  node.temperature_c = 31;
  node.error_register = 0;
  EXPECT_TRUE(module()["angle"].is_null());
  EXPECT_EQ(module()["current"], 350);
  EXPECT_EQ(module()["temperature"], 31);
  EXPECT_TRUE(module()["fault"].is_null());
}

TEST_F(BusDocumentTest, ALimitOfTheCurrentThatIsOffIsNotAnUnknownOne) {
  node.current_limit = 2000;
  EXPECT_EQ(module()["current_limit"], 2000);
  node.current_limit = 0;
  EXPECT_EQ(module()["current_limit"], 0);
}

TEST_F(BusDocumentTest, AFaultSaysWhatToDo) {
  node.error_register = 3;
  node.last_emergency = canopen::Emergency{4, canopen::EmergencyCode::over_current, 3, 0};
  EXPECT_EQ(module()["fault"], canopen::describe(canopen::EmergencyCode::over_current));
  EXPECT_NE(module()["advice"].get<std::string>().find("blocked"), std::string::npos);
  node.error_register = 0;
  EXPECT_TRUE(module()["fault"].is_null()) << "the error is over";
}

TEST_F(BusDocumentTest, CountsSyncsOfASecondAndTellsSilence) {
  view.nodes = {node};
  EXPECT_EQ(bus_document(scenario.modules, view)["syncs"], 100);
  EXPECT_EQ(module()["silent"], false);
  node.last_heard = view.now - 2'000'000;
  EXPECT_EQ(module()["silent"], true);
}

TEST_F(BusDocumentTest, TellsWhichModulesHaveConfirmedAStop) {
  view.stop_confirmed = {true, true, true, false, true};
  EXPECT_EQ(module()["stop_confirmed"], false);
  node.node = 5;
  EXPECT_EQ(module()["stop_confirmed"], true);
}

}  // namespace
}  // namespace proleg::tools
