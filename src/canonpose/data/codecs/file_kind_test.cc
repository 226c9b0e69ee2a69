#include "canonpose/data/codecs/file_kind.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"

namespace canonpose {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryFolder;

TEST(FileKind, IsRecognisedByTheFirstBytes) {
  EXPECT_EQ(KindOfBytes("RIFF1234AVI LIST"), "a video");
  EXPECT_EQ(KindOfBytes("\x89PNG\r\n"), "an image");
  EXPECT_EQ(KindOfBytes("\x93NUMPY"), "a NumPy file");
  EXPECT_EQ(KindOfBytes("PK\x03\x04"), "a zip archive");
  EXPECT_EQ(KindOfBytes("{\"people\": []}"), "");
  EXPECT_EQ(KindOfBytes(""), "");
}

TEST(FileKind, VideosWithoutASignatureAreRecognisedByTheirExtension) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder / "a.MTS", "something");
  WriteFileAtomically(folder / "a.json", "something");
  EXPECT_EQ(KindOfFile(folder / "a.MTS"), "a video");
  EXPECT_EQ(KindOfFile(folder / "a.json"), "");
  EXPECT_EQ(KindOfFile(folder / "nothing.mp4"), "");
  EXPECT_EQ(KindOfFile(folder.path()), "");
}

TEST(FileKind, HasAdvice) {
  EXPECT_THAT(AdviceForKind("a video"), HasSubstr("run a 2D keypoint detector"));
  EXPECT_THAT(AdviceForKind("a zip archive"), HasSubstr("unpack"));
  EXPECT_EQ(AdviceForKind(""), "");
}

}  // namespace
}  // namespace canonpose
