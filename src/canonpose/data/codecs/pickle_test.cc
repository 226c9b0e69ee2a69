#include "canonpose/data/codecs/pickle.h"

#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/random.h"
#include "canonpose/base/testing.h"

namespace canonpose::pickle {
namespace {

using canonpose::testing::ErrorOf;
using canonpose::testing::TestData;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::filesystem::path File(const std::string& name) { return TestData("benchmarks/pickles") / name; }

std::string Refusal(const std::string& bytes) {
  return ErrorOf(ErrorKind::kBadInput, [&] { Decode(bytes, "x.pickle"); });
}

std::vector<double> NumbersAt(const Value& root, const std::string& key) {
  EXPECT_EQ(root[key].ToNumbers().shape, (std::vector<std::size_t>{2, 3})) << key;
  return root[key].ToNumbers().values;
}

void ExpectPlainValues(const Value& root) {
  EXPECT_EQ(root["none"].kind(), Kind::kNone);
  EXPECT_EQ(root["true"].Describe(), "True");
  EXPECT_EQ(root["false"].Describe(), "False");
  EXPECT_EQ(root["small"].Integer(), 7);
  EXPECT_EQ(root["negative"].Integer(), -3);
  EXPECT_EQ(root["byte"].Integer(), 200);
  EXPECT_EQ(root["short"].Integer(), 40000);
  EXPECT_EQ(root["int"].Integer(), -2000000000);
  EXPECT_EQ(root["long"].Integer(), std::int64_t{1} << 40);
  EXPECT_EQ(root["least"].Integer(), INT64_MIN);
  EXPECT_EQ(root["real"].Describe(), "-0.1");
  EXPECT_EQ(root["text"].Text(), "Fuß 漢\n\\u0041");
  EXPECT_EQ(root["empty text"].Text(), "");
  EXPECT_EQ(root["bytes"].Text(), std::string("\x00\xff\n", 3));
  EXPECT_EQ(root["no bytes"].Text(), "");
  EXPECT_EQ(root["long text"].Text(), std::string(300, 'x'));
  EXPECT_EQ(root["12"].Text(), "twelve");
  EXPECT_EQ(root["list"].size(), 3U);
  EXPECT_THAT(root["list"].At(1).Integers(), ElementsAre(2, 3));
  EXPECT_EQ(root["list"].At(2).size(), 0U);
  EXPECT_THAT(root["tuple"].At(3).Integers(), ElementsAre(3, 4, 5, 6));
  EXPECT_THAT(root["shared"].At(1).Integers(), ElementsAre(1, 2));
}

void ExpectArrays(const Value& root) {
  EXPECT_THAT(NumbersAt(root, "f4"), ElementsAre(0, 1, 2, 3, 4, 5));
  EXPECT_THAT(NumbersAt(root, "f8"), ElementsAre(0, 0.5, 1, 1.5, 2, 2.5));
  EXPECT_THAT(NumbersAt(root, "f2"), ElementsAre(-1, -0.75, -0.5, -0.25, 0, 0.25));
  for (const char* const type : {"i1", "i2", "i8"})
    EXPECT_THAT(NumbersAt(root, type), ElementsAre(-3, -2, -1, 0, 1, 2));
  EXPECT_THAT(NumbersAt(root, "u1"), ElementsAre(250, 251, 252, 253, 254, 255));
  EXPECT_EQ(NumbersAt(root, "u4").back(), 4000000005.0);
  EXPECT_THAT(NumbersAt(root, "bool"), ElementsAre(0, 1, 0, 1, 0, 1));
  EXPECT_THAT(NumbersAt(root, "fortran"), ElementsAre(0, 1, 2, 3, 4, 5));
  EXPECT_THAT(NumbersAt(root, "strided"), ElementsAre(0, 2, 4, 6, 8, 10));
  EXPECT_EQ(root["objects"].size(), 2U);
  EXPECT_EQ(root["objects"].At(0).ToNumbers().values.size(), 6U);
  EXPECT_EQ(root["objects"].At(1).kind(), Kind::kNone);
  EXPECT_EQ(root["nothing"].ToNumbers().shape, (std::vector<std::size_t>{0, 3}));
  EXPECT_EQ(root["wrapped"].Unwrapped()["a"].Integer(), 1);
  EXPECT_THAT(root["point"].ToNumbers().values, ElementsAre(2.5));
  EXPECT_EQ(root["scalar"].Describe(), "1.5");
  EXPECT_EQ(root["count"].Integer(), (std::int64_t{1} << 60) + 1);
  EXPECT_EQ(root["down"].Integer(), -5);
  EXPECT_EQ(root["flag"].Describe(), "True");
}

TEST(PickleTest, EveryProtocolGivesTheSameValues) {
  for (const char* const version : {"p0", "p1", "p2", "p3", "p4", "p5", "numpy2_p2", "numpy2_p5"}) {
    SCOPED_TRACE(version);
    const Value root = Load(File(fmt::format("values_{}.pickle", version)));
    EXPECT_EQ(root.Keys().size(), 41U);
    ExpectPlainValues(root);
    ExpectArrays(root);
  }
}

TEST(PickleTest, MissingAndWrongValuesAreReported) {
  const Value root = Load(File("values_p5.pickle"));
  const auto refusal = [](auto action) { return ErrorOf(ErrorKind::kBadInput, action); };
  EXPECT_THAT(refusal([&] { (void)root["nowhere"]; }),
              AllOf(HasSubstr("member \"nowhere\""), HasSubstr("none, true, false")));
  EXPECT_THAT(refusal([&] { (void)root["text"].Integer(); }), HasSubstr("[\"text\"]: expected a whole number"));
  EXPECT_THAT(refusal([&] { (void)root["list"].At(1).At(2); }), HasSubstr("[\"list\"][1]"));
  EXPECT_THAT(refusal([&] { (void)root["list"].ToNumbers(); }), HasSubstr("[\"list\"][1]: expected a number"));
  EXPECT_THAT(refusal([&] { (void)root["f8"].Integers(); }), HasSubstr("one row of whole numbers"));
  EXPECT_THAT(refusal([&] { (void)root["texts"].ToNumbers(); }), HasSubstr("an array (2) of '<U1'"));
  EXPECT_THAT(refusal([&] { (void)root["big endian"].ToNumbers(); }), HasSubstr("little-endian"));
  EXPECT_THAT(refusal([&] { (void)root["objects"].ToNumbers(); }), HasSubstr("'|O8'"));
}

TEST(PickleTest, NothingIsExecuted) {
  for (const char* const protocol : {"p0", "p2", "p5"}) {
    EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { Load(File(fmt::format("os_system_{}.pickle", protocol))); }),
                AllOf(HasSubstr("the name posix.system"), HasSubstr("nothing was executed")));
    EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { Load(File(fmt::format("eval_{}.pickle", protocol))); }),
                HasSubstr(".eval"));
  }
  EXPECT_FALSE(std::filesystem::exists("/tmp/canonpose-was-executed"));
  EXPECT_THAT(Refusal("cos\nsystem\n(S'ls'\ntR."), HasSubstr("os.system"));
  EXPECT_THAT(Refusal("(S'ls'\nios\nsystem\n."), HasSubstr("os.system"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [] { Load(File("numpy_load.pickle")); }), HasSubstr("numpy.load"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [] { Load(File("object.pickle")); }), HasSubstr("pathlib.PurePosixPath"));
  // Known names do not make other calls possible.
  EXPECT_THAT(Refusal("cnumpy\nndarray\n(tR."), HasSubstr("a call of numpy.ndarray"));
  EXPECT_THAT(Refusal("cnumpy\nndarray\n(to."), HasSubstr("an object of a class"));
  EXPECT_THAT(Refusal("cnumpy\nndarray\n(t\x81."), HasSubstr("an object of a class"));
  EXPECT_THAT(Refusal("Pname\n."), HasSubstr("outside the file"));
  EXPECT_THAT(Refusal("c\x1b[31m\nx\n."), HasSubstr("?[31m.x"));
}

TEST(PickleTest, EndlessAndTooLargeValuesAreRefused) {
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [] { Load(File("endless.pickle")); }), HasSubstr("contains itself"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [] { Load(File("deep.pickle")); }), HasSubstr("more than 100 deep"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [] { Load(File("set.pickle")); }), HasSubstr("a set"));
  EXPECT_THAT(Refusal(std::string("\x80\x06N.", 4)), HasSubstr("protocol 6"));
  EXPECT_THAT(Refusal(std::string("\x8e\xff\xff\xff\xff\xff\xff\xff\x7f.", 10)), HasSubstr("where 1 remain"));
  EXPECT_THAT(Refusal(std::string("\x95\xff\xff\x00\x00\x00\x00\x00\x00N.", 11)), HasSubstr("a frame of 65535 bytes"));
  EXPECT_THAT(Refusal(std::string("\x8b\x10\x00\x00\x00", 5) + std::string(16, '\1') + "."), HasSubstr("16 bytes"));
  EXPECT_THAT(Refusal("\xff."), HasSubstr("instruction 0xff"));
  // An array whose shape claims more than its bytes, even more than 64 bits can count.
  const std::string type = "cnumpy\ndtype\n(S'f8'\ntR(I3\nS'<'\ntbp1\n0";
  const std::string array = "cnumpy.core.multiarray\n_reconstruct\n(cnumpy\nndarray\n(I0\ntS'b'\ntR(I1\n(";
  EXPECT_THAT(Refusal(type + array + "I2\ntg1\nI00\nS'12345678'\ntb."), HasSubstr("8 bytes for an array (2) of '<f8'"));
  EXPECT_THAT(Refusal(type + array + "L4611686018427387904L\nI4\ntg1\nI00\nS''\ntb."),
              HasSubstr("0 bytes for an array"));
  EXPECT_EQ(Decode(type + array + "I1\ntg1\nI00\nS'\\x00\\x00\\x00\\x00\\x00\\x00\\xf0?'\ntb.", "x").ToNumbers().values,
            std::vector<double>{1.0});
  EXPECT_THAT(Refusal("cnumpy.core.multiarray\n_reconstruct\n(cnumpy\nndarray\n(I0\ntS'b'\ntR."),
              HasSubstr("without its numbers"));
  // The same text encoded a thousand times over.
  std::string copies = "(V" + std::string(20000, 'x') + "\np0\n0c_codecs\nencode\np1\n0Vlatin1\np2\n0";
  for (int i = 0; i < 1000; ++i) copies += "g1\n(g0\ng2\ntR";
  EXPECT_THAT(Refusal(copies + "l."), HasSubstr("over and over"));
}

/// Decodes and visits everything; anything other than Error(kBadInput) ends the test.
bool Reads(const std::string& bytes) {
  try {
    const Value root = Decode(bytes, "x.pickle");
    if (root.kind() != Kind::kDictionary) return true;
    for (const std::string& key : root.Keys()) {
      if (root[key].IsNumbers()) (void)root[key].ToNumbers();
      (void)root[key].Describe();
    }
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput) << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return false;
  }
  return true;
}

TEST(PickleTest, DamagedFilesAreReadOrRefused) {
  Rng rng(5);
  for (const char* const version : {"p0", "p2", "p4", "p5"}) {
    const std::string whole = ReadFile(File(fmt::format("values_{}.pickle", version)));
    for (std::size_t length = 0; length < whole.size(); length += 7)
      EXPECT_FALSE(Reads(whole.substr(0, length))) << length;
    for (int i = 0; i < 2000; ++i) {
      std::string bytes = whole;
      for (std::size_t n = 0; n <= rng.Index(4); ++n)
        bytes[rng.Index(bytes.size())] = static_cast<char>(rng.Index(256));
      Reads(bytes);
    }
  }
}

}  // namespace
}  // namespace canonpose::pickle
