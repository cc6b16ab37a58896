// A target needs a source; the headers are what matters (tests/CMakeLists.txt).
