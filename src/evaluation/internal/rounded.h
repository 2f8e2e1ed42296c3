// Numbers as evaluation.json prints them.
#pragma once

namespace rigmap {

// To the nearest number with so many decimals, judged on the exact binary value, ties to even.
double Rounded(double value, int decimals);

}  // namespace rigmap
