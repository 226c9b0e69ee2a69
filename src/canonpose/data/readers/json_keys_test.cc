#include "canonpose/data/readers/json_keys.h"

#include <string>

#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"

namespace canonpose {
namespace {

JsonValue Load(const std::string& text) {
  const testing::TemporaryFolder folder;
  WriteFileAtomically(folder / "a.json", text);
  return JsonValue::Load(folder / "a.json");
}

TEST(JsonKeys, TheFirstKeyWithAValueIsTaken) {
  const JsonValue entry = Load(R"({"frame_index":7,"frame":null,"frame_id":5})");
  EXPECT_EQ(FindAny(entry, kFrameKeys).value().Integer(), 5);
  EXPECT_FALSE(FindAny(entry, kFrameListKeys).has_value());
  EXPECT_FALSE(FindAny(Load("[1]"), kFrameKeys).has_value()) << "no object";
}

TEST(JsonKeys, ACountOfFramesIsNoList) {
  EXPECT_EQ(FindAnyList(Load(R"({"frames":2,"results":[4,5,6]})"), kFrameListKeys).value().ArraySize(), 3U);
  EXPECT_EQ(FindAnyList(Load(R"({"frames":{"0":[]},"results":[]})"), kFrameListKeys).value().Keys().size(), 1U);
  EXPECT_FALSE(FindAnyList(Load(R"({"frames":2,"data":null})"), kFrameListKeys).has_value());
}

}  // namespace
}  // namespace canonpose
