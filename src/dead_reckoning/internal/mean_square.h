// How far innovations are off, in sigmas. Of this room only.
#pragma once

namespace rigmap {

// A mean square of normalised innovations, drawn to what is expected.
class MeanSquare {
 public:
  explicit MeanSquare(int coordinates) : squares_(kAsExpected * coordinates), count_(squares_) {}

  void Add(double sigmas, int coordinates) {
    squares_ += coordinates * sigmas * sigmas;
    count_ += coordinates;
  }
  double Value() const { return squares_ / count_; }

 private:
  static constexpr double kAsExpected = 2.0;  // steps
  double squares_, count_;
};

}  // namespace rigmap
