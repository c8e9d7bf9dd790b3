// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/packed_page.hpp"

#include <zlib.h>

#ifdef TUINA_PACKED_PAGE
// Names that the linker gives to the first byte of a file, and to the one behind its last.
extern "C" {
extern const char _binary_index_html_gz_start, _binary_index_html_gz_end;
extern const char _binary_page_js_gz_start, _binary_page_js_gz_end;
extern const char _binary_page_css_gz_start, _binary_page_css_gz_end;
extern const char _binary_icon_svg_gz_start, _binary_icon_svg_gz_end;
}
#endif

namespace tuina::app {

std::string_view packed_page([[maybe_unused]] std::string_view name) {
#ifdef TUINA_PACKED_PAGE
  const auto file = [](const char& begin, const char& end) {
    return std::string_view(&begin, static_cast<std::size_t>(&end - &begin));
  };
  if (name == "index.html") return file(_binary_index_html_gz_start, _binary_index_html_gz_end);
  if (name == "page.js") return file(_binary_page_js_gz_start, _binary_page_js_gz_end);
  if (name == "page.css") return file(_binary_page_css_gz_start, _binary_page_css_gz_end);
  if (name == "icon.svg") return file(_binary_icon_svg_gz_start, _binary_icon_svg_gz_end);
#endif
  return {};
}

Result<std::string> unpacked(std::string_view gzip) {
  constexpr std::size_t max_bytes = 16 << 20;
  constexpr int with_head_of_gzip = 16 + MAX_WBITS;
  std::string text(max_bytes, '\0');
  z_stream stream{};
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(gzip.data()));
  stream.avail_in = static_cast<uInt>(gzip.size());
  stream.next_out = reinterpret_cast<Bytef*>(text.data());
  stream.avail_out = static_cast<uInt>(text.size());
  if (inflateInit2(&stream, with_head_of_gzip) != Z_OK)
    return fail(Fault::bad_input, "zlib does not begin");
  const int ended = inflate(&stream, Z_FINISH);
  inflateEnd(&stream);
  if (ended != Z_STREAM_END) return fail(Fault::bad_input, "this is no gzip of 16 MB at most");
  text.resize(stream.total_out);
  text.shrink_to_fit();
  return text;
}

}  // namespace tuina::app
