// SPDX-License-Identifier: Apache-2.0
#include "tuina/web/login.hpp"

#include <civetweb.h>
#include <fmt/format.h>

#include "tuina/web/password.hpp"

namespace tuina::web {
namespace {

constexpr const char* before =
    R"(<!doctype html><html lang="en"><meta charset="utf-8"><title>tuina</title>
<meta name="viewport" content="width=device-width,initial-scale=1"><meta name="color-scheme" content="light dark">
<style>body{font:17px/1.5 system-ui,sans-serif;margin:0;min-height:100vh;display:grid;place-items:center;background:#fbfaf8;color:#1f232a}
main{width:min(21em,88vw)}h1{font-size:26px;margin:0 0 20px}label{display:block;margin-bottom:6px}
input,button{font:inherit;box-sizing:border-box;width:100%;min-height:48px;border-radius:10px;border:1px solid #70766f;padding:0 14px;background:#fff;color:inherit}
button{margin-top:14px;background:#c8342c;border-color:#c8342c;color:#fff;font-weight:600}p{margin:0 0 14px;color:#a1121a;font-weight:600}
:focus-visible{outline:3px solid #4a90e2;outline-offset:2px}
@media(prefers-color-scheme:dark){body{background:#14171c;color:#eceef1}input{background:#20242b}p{color:#ff9a96}}</style>
<main><h1>tuina <span lang="zh-Hant">推拿</span></h1>)";
constexpr const char* after =
    R"(<form method="post" action="/login"><label for="password">Password <span lang="zh-Hant">密碼</span></label>
<input id="password" name="password" type="password" autocomplete="current-password" maxlength="256" required autofocus>
<button>Log in <span lang="zh-Hant">登入</span></button></form></main></html>
)";
constexpr const char* wrong =
    R"(<p role="alert">That is not the password. <span lang="zh-Hant">密碼不正確。</span></p>)";
constexpr const char* too_often =
    R"(<p role="alert">Too many attempts: wait a minute. <span lang="zh-Hant">嘗試次數過多，請稍候一分鐘。</span></p>)";

}  // namespace

Reply login_page(LoginAnswer answer) {
  const bool slow = answer == LoginAnswer::too_often;
  const char* words = slow ? too_often : answer == LoginAnswer::wrong ? wrong : "";
  return {.status = slow ? 429 : 401,
          .type = "text/html; charset=utf-8",
          .body = fmt::format("{}{}{}", before, words, after),
          .headers = {{"Content-Security-Policy",
                       "default-src 'none'; style-src 'unsafe-inline'; base-uri 'none'; "
                       "form-action 'self'; frame-ancestors 'none'"}}};
}

std::string password_of(std::string_view form) {
  std::string password(max_password_bytes + 1, '\0');
  const int size =
      mg_get_var(form.data(), form.size(), "password", password.data(), password.size());
  if (size <= 0) return "";
  password.resize(static_cast<std::size_t>(size));
  return password;
}

}  // namespace tuina::web
