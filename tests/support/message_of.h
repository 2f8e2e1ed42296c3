// What a deed complains of.
#pragma once

#include <gtest/gtest.h>

#include <exception>
#include <string>

namespace rigmap {

// What `deed` throws as Failure; a test failure and "" if it does not.
template <class Failure, class Deed>
std::string MessageOf(const Deed& deed) {
  try {
    deed();
  } catch (const Failure& failure) {
    return failure.what();
  } catch (const std::exception& other) {
    ADD_FAILURE() << "threw something else: " << other.what();
    return "";
  }
  ADD_FAILURE() << "threw nothing";
  return "";
}

}  // namespace rigmap
