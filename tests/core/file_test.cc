#include "core/file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cerrno>
#include <csignal>
#include <iterator>
#include <ostream>

#include "core/error.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

using testing::HasSubstr;

std::ptrdiff_t CountEntries(const std::filesystem::path& folder) {
  return std::distance(std::filesystem::directory_iterator(folder),
                       std::filesystem::directory_iterator());
}

TEST(FileTest, WriteAndReadAreInverse) {
  const TemporaryFolder folder;
  const auto path = folder.Path() / "deep" / "er" / "file.bin";
  for (const std::string& content :
       {std::string("a\r\nb\0c", 6), std::string(), std::string("x")}) {
    WriteFileAtomically(path, [&](std::ostream& stream) { stream << content; });
    EXPECT_EQ(ReadTextFile(path), content);
  }
  EXPECT_EQ(CountEntries(path.parent_path()), 1);
}

TEST(FileTest, AByteOrderMarkIsNoText) {
  const TemporaryFolder folder;
  EXPECT_EQ(ReadTextFile(folder.Write("marked.txt",
                                      "\xEF\xBB\xBF"
                                      "0.5 1\n")),
            "0.5 1\n");
  EXPECT_EQ(ReadTextFile(folder.Write("mark.txt", "\xEF\xBB\xBF")), "");
  EXPECT_EQ(ReadBytes(folder.Path() / "mark.txt"), "\xEF\xBB\xBF") << "of a binary file";
  EXPECT_EQ(ReadTextFile(folder.Write("other.txt", "1 \xEF\xBB\xBF")), "1 \xEF\xBB\xBF");
}

TEST(ReadTextFile, ADeviceWithoutAnEndIsRefused) {
  EXPECT_EQ(ReadTextFile("/dev/null"), "");
  EXPECT_THAT(MessageOf<DataError>([] { ReadTextFile("/dev/zero"); }),
              HasSubstr("/dev/zero: expected a file"));
}

TEST(FileTest, ThrowingWriterLeavesTheOldFileAndNothingElse) {
  const TemporaryFolder folder;
  const auto path = folder.Write("file.txt", "old");
  EXPECT_THROW(WriteFileAtomically(path,
                                   [](std::ostream& stream) {
                                     stream << "half of the ne";
                                     throw std::runtime_error("stop");
                                   }),
               std::runtime_error);
  EXPECT_EQ(ReadTextFile(path), "old");
  EXPECT_EQ(CountEntries(folder.Path()), 1);
}

TEST(FileTest, FailedStreamLeavesTheOldFile) {
  const TemporaryFolder folder;
  const auto path = folder.Write("file.txt", "old");
  const auto fail = [](std::ostream& stream) { stream.setstate(std::ios::badbit); };
  EXPECT_THROW(WriteFileAtomically(path, fail), DataError);
  EXPECT_EQ(ReadTextFile(path), "old");
  EXPECT_EQ(CountEntries(folder.Path()), 1);
}

// Who writes may find out first, but does not know of which file.
TEST(FileTest, FullDiskIsSaidWithTheFileWhateverTheWriterThrows) {
  const TemporaryFolder folder;
  const auto path = folder.Path() / "file.txt";
  const auto fail = [](std::ostream& stream) {
    stream.setstate(std::ios::badbit);
    errno = ENOSPC;
    throw std::runtime_error("wrote 0 bytes");
  };
  EXPECT_THAT(MessageOf<DataError>([&] { WriteFileAtomically(path, fail); }),
              testing::AllOf(HasSubstr(path.string()), HasSubstr("No space left on device")));
  EXPECT_EQ(CountEntries(folder.Path()), 0);
}

TEST(FileTest, TheOldFileIsThereUntilTheEnd) {
  const TemporaryFolder folder;
  const auto path = folder.Write("file.txt", "old");
  WriteFileAtomically(path, [&](std::ostream& stream) {
    stream << "new" << std::flush;
    EXPECT_EQ(ReadTextFile(path), "old");
  });
  EXPECT_EQ(ReadTextFile(path), "new");
}

// A folder stands where the temporary would: the reason is the operating system's.
TEST(FileTest, FailureToOpenSaysWhy) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.Path() / "file.txt.unfinished" / "inside");
  const auto message = MessageOf<DataError>([&] {
    WriteFileAtomically(folder.Path() / "file.txt", [](std::ostream& stream) { stream << "x"; });
  });
  EXPECT_THAT(message, HasSubstr("Is a directory"));
}

TEST(FileTest, WhatCannotBeReadIsNamed) {
  const TemporaryFolder folder;
  const auto missing = folder.Path() / "none.txt";
  EXPECT_THAT(MessageOf<DataError>([&] { ReadTextFile(missing); }),
              testing::AllOf(HasSubstr(missing.string()), HasSubstr("No such file")));
  EXPECT_THAT(MessageOf<DataError>([&] { ReadTextFile(folder.Path()); }),
              HasSubstr("expected a file, found a folder"));
}

TEST(FolderTest, NewFolderReplacesTheOld) {
  const TemporaryFolder folder;
  folder.Write("model/old.txt", "old");
  const auto path = folder.Path() / "model";
  WriteFolderAtomically(path, [&](const std::filesystem::path& temporary) {
    EXPECT_TRUE(IsTemporaryName(temporary.filename().string()));
    EXPECT_TRUE(std::filesystem::exists(path / "old.txt"));
    WriteFileAtomically(temporary / "new.txt", [](std::ostream& stream) { stream << "new"; });
  });
  EXPECT_EQ(ReadTextFile(path / "new.txt"), "new");
  EXPECT_EQ(CountEntries(path), 1);
  EXPECT_EQ(CountEntries(folder.Path()), 1);
}

TEST(FolderTest, ThrowingWriterLeavesTheOldFolderAndNothingElse) {
  const TemporaryFolder folder;
  folder.Write("model/old.txt", "old");
  const auto path = folder.Path() / "model";
  EXPECT_THROW(WriteFolderAtomically(path,
                                     [](const std::filesystem::path& temporary) {
                                       std::ofstream(temporary / "half.txt") << "half";
                                       throw std::runtime_error("stop");
                                     }),
               std::runtime_error);
  EXPECT_EQ(ReadTextFile(path / "old.txt"), "old");
  EXPECT_EQ(CountEntries(folder.Path()), 1);
}

TEST(FolderTest, LeftoversOfAKilledRunDoNotStay) {
  const TemporaryFolder folder;
  folder.Write("model.unfinished/half.txt", "half");
  const auto path = folder.Path() / "model";
  WriteFolderAtomically(path, [](const std::filesystem::path& temporary) {
    std::ofstream(temporary / "new.txt") << "new";
  });
  EXPECT_EQ(CountEntries(path), 1);
  EXPECT_EQ(CountEntries(folder.Path()), 1);
}

// As a full disk does, while the writer has other files open as well.
TEST(FileTest, AFailedWriteIsToldByItsOwnReason) {
  const TemporaryFolder folder;
  const auto path = folder.Path() / "large.bin";
  rlimit before;
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit small{1 << 16, before.rlim_max};
  const auto old = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const std::string complaint = MessageOf<DataError>([&] {
    WriteFileAtomically(path, [&](std::ostream& stream) {
      for (int i = 0; i < 100; ++i) {
        stream << std::string(10000, 'x');
        errno = ENOENT;  // of another file
      }
      if (!stream) throw std::runtime_error("the stream failed");
    });
  });
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, old);
  EXPECT_THAT(complaint, HasSubstr("large.bin: cannot write: File too large"));
  EXPECT_EQ(CountEntries(folder.Path()), 0);
}

TEST(FileTest, TemporaryNames) {
  EXPECT_TRUE(IsTemporaryName("file.txt.unfinished"));
  EXPECT_FALSE(IsTemporaryName("file.txt"));
}

}  // namespace
}  // namespace rigmap
