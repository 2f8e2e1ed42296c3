// What a stage keeps that makes nothing but what it publishes.
#pragma once

namespace rigmap {

struct Published {
  template <class Archive>
  void serialize(Archive&) {}
};

}  // namespace rigmap
