#include "host/remote/binding_store.hpp"

#include <gtest/gtest.h>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/temporary_folder.hpp"

namespace proleg::host {
namespace {

const std::vector<Binding> stop_button{{"Pad", "BTN_EAST", RemoteAction::stop}};

class Store : public testing::Test {
 protected:
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "robot.remote.json";
};

TEST_F(Store, BeginsWithoutAFile) {
  const BindingStore store(path);
  EXPECT_TRUE(store.read_bindings().empty());
  EXPECT_TRUE(store.has({}));
  EXPECT_FALSE(store.has(stop_button));
}

TEST_F(Store, KeepsBindingsForTheNextStart) {
  BindingStore store(path);
  store.save(stop_button);
  EXPECT_TRUE(store.has(stop_button));
  const BindingStore next(path);
  EXPECT_TRUE(next.has(stop_button));
  EXPECT_EQ(folder.names(), std::vector<std::string>{"robot.remote.json"});
}

TEST_F(Store, WritesNothingOverAFileThatSomebodyElseHasChanged) {
  BindingStore store(path);
  write_file(path, "mine");
  EXPECT_EQ(message_of<std::runtime_error>([&] { store.save(stop_button); }),
            path.string() + ": somebody has changed the file meanwhile; nothing was written");
  EXPECT_EQ(file_contents(path), "mine");
}

TEST_F(Store, RefusesAFileThatIsNone) {
  write_file(path, "mine");
  EXPECT_EQ(message_of<InputError>([&] { const BindingStore store(path); }),
            path.string() + ":1: found text that is not JSON, expected an object in JSON");
  EXPECT_NE(message_of<InputError>([&] { const BindingStore store(folder.path()); }), "");
}

TEST_F(Store, SavesNothingWithoutAScenario) {
  BindingStore store;
  EXPECT_NE(message_of<std::runtime_error>([&] { store.save(stop_button); }), "");
}

}  // namespace
}  // namespace proleg::host
