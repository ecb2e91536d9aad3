#pragma once
namespace tessera::tracer {
struct Shutter {
  double open = 0, close = 0;
};
}
