#pragma once

namespace shadowcache {

/// Answers the requests that come on standard input by lines on standard output (docs/serve.md),
/// until quit or the end of the input, which stops what runs.
///
/// @param threads  of all work; 0: every core
void serve(int threads);

}  // namespace shadowcache
