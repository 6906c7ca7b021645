#include "host/server/request_policy.hpp"

#include <gtest/gtest.h>

#include <tuple>

namespace proleg::host {
namespace {

const ServerAddress local{8123, false, {}};
const ServerAddress lan{8123, true, {"robot.local", "[2001:db8::7]"}};

class RequestPolicy : public testing::Test {
 protected:
  RequestFields get(std::string_view target) const { return {"GET", target, {"localhost:8123"}, {}, {}, false}; }
  RequestFields post() const { return {"POST", "/stop", {"localhost:8123"}, {}, {bearer}, false}; }
  RequestAction action(const RequestFields& request) const { return decide_request(request, local, token).action; }
  /// Status of a refusal; 0 if there is none.
  unsigned refusal(const RequestFields& request) const { return refusal(request, local); }
  unsigned refusal(const RequestFields& request, const ServerAddress& address) const {
    return decide_request(request, address, token).status;
  }

  const AccessToken token = AccessToken::make();
  const std::string bearer = "Bearer " + token.text();
};

TEST_F(RequestPolicy, FilesNeedNoToken) {
  EXPECT_EQ(action(get("/")), RequestAction::serve_file);
  EXPECT_EQ(action(get("/app.js?1")), RequestAction::serve_file);
  RequestFields head = get("/");
  head.method = "HEAD";
  EXPECT_EQ(action(head), RequestAction::serve_file);
}

TEST_F(RequestPolicy, AHostIsOneOfThreeNamesWithThePort) {
  RequestFields request = get("/");
  for (const std::string_view host : {"127.0.0.1:8123", "localhost:8123", "[::1]:8123"}) {
    request.hosts = {host};
    EXPECT_EQ(action(request), RequestAction::serve_file) << host;
  }
  for (const std::string_view host :
       {"", "localhost", "localhost:", "localhost:80", "localhost:812", "localhost:81230", "localhost:08123",
        "localhost..:8123", ".:8123", ":8123", "[::1]", "[::1:8123", "127.0.0.1.evil.example:8123", "evil.example:8123",
        "localhost:8123 ", "::1:8123", "127.1:8123"}) {
    request.hosts = {host};
    EXPECT_EQ(refusal(request), 421U) << host;
  }
  request.hosts = {};
  EXPECT_EQ(refusal(request), 421U);
  request.hosts = {"localhost:8123", "localhost:8123"};
  EXPECT_EQ(refusal(request), 421U);
}

TEST_F(RequestPolicy, AnOriginIsThatOfTheHost) {
  for (RequestFields request : {get("/"), post()}) {
    request.origins = {"http://localhost:8123"};
    EXPECT_EQ(refusal(request), 0U);
    for (const std::string_view origin :
         {"http://127.0.0.1:8123", "https://localhost:8123", "null", "", "http://localhost:8123.evil.example",
          "http://localhost:8123/", "http://localhost", "HTTP://localhost:8123"}) {
      request.origins = {origin};
      EXPECT_EQ(refusal(request), 403U) << origin;
    }
    request.origins = {"http://localhost:8123", "http://evil.example"};
    EXPECT_EQ(refusal(request), 403U);
  }
}

TEST_F(RequestPolicy, OtherComputersUseANameOfTheCertificateAndHttps) {
  RequestFields request = get("/");
  for (const std::string host : {"robot.local:8123", "[2001:db8::7]:8123", "localhost:8123", "127.0.0.1:8123"}) {
    const std::string origin = "https://" + host;
    const std::string plain_origin = "http://" + host;
    request.hosts = {host};
    request.origins = {origin};
    EXPECT_EQ(refusal(request, lan), 0U) << host;
    request.origins = {plain_origin};
    EXPECT_EQ(refusal(request, lan), 403U) << host;
  }
  request.origins = {};
  for (const std::string_view host :
       {"robot.local", "robot.local:8124", "robot:8123", "xrobot.local:8123", "evil.example:8123"}) {
    request.hosts = {host};
    EXPECT_EQ(refusal(request, lan), 421U) << host;
  }
  request.hosts = {"robot.local:8123"};
  EXPECT_EQ(refusal(request), 421U) << "without a certificate";
}

TEST_F(RequestPolicy, BrowsersLeaveOutThePortOfHttps) {
  const ServerAddress https{443, true, {"robot.local"}};
  RequestFields request = get("/");
  request.hosts = {"robot.local"};
  request.origins = {"https://robot.local"};
  EXPECT_EQ(refusal(request, https), 0U);
  EXPECT_EQ(first_origin(https), "https://robot.local");
}

TEST_F(RequestPolicy, TheDefaultPortMayBeThereOrNot) {
  for (const auto& [address, scheme, port] :
       {std::tuple(ServerAddress{443, true, {"robot.local"}}, "https://", ":443"),
        std::tuple(ServerAddress{80, false, {"robot.local"}}, "http://", ":80")}) {
    for (const std::string host : {"robot.local", "localhost", "[::1]"}) {
      const std::string plain = scheme + host;
      const std::string full = plain + port;
      const std::string host_with_port = host + port;
      RequestFields request = get("/");
      for (const std::string_view one : {std::string_view(host), std::string_view(host_with_port)}) {
        request.hosts = {one};
        for (const std::string& origin : {plain, full}) {
          request.origins = {origin};
          EXPECT_EQ(refusal(request, address), 0U) << one << " " << origin;
        }
      }
      const std::string other = plain + ":444";
      request.origins = {other};
      EXPECT_EQ(refusal(request, address), 403U);
      request.origins = {};
      request.hosts = {std::string_view(other).substr(std::string_view(scheme).size())};
      EXPECT_EQ(refusal(request, address), 421U);
    }
  }
}

TEST_F(RequestPolicy, NamesHaveNoCaseAndMayEndInTheDotOfTheRoot) {
  RequestFields request = get("/");
  for (const std::string_view host :
       {"ROBOT.Local:8123", "robot.local.:8123", "LocalHost:8123", "[2001:DB8::7]:8123"}) {
    const std::string origin = "https://" + std::string(host);
    request.hosts = {host};
    request.origins = {origin};
    EXPECT_EQ(refusal(request, lan), 0U) << host;
    request.origins = {"https://evil.example:8123"};
    EXPECT_EQ(refusal(request, lan), 403U) << host;
  }
}

TEST_F(RequestPolicy, AWildcardIsOneLabel) {
  const ServerAddress wide{8123, true, {}, {"*.lab.example"}};
  RequestFields request = get("/");
  for (const std::string_view host : {"robot.lab.example:8123", "ROBOT-2.LAB.example.:8123"}) {
    request.hosts = {host};
    EXPECT_EQ(refusal(request, wide), 0U) << host;
  }
  for (const std::string_view host :
       {"lab.example:8123", ".lab.example:8123", "a.b.lab.example:8123", "*.lab.example:8123", "xlab.example:8123",
        "a lab.example:8123", "robot.lab.example.evil:8123", "robot.lab.example:8124", "a@b.lab.example:8123"}) {
    request.hosts = {host};
    EXPECT_EQ(refusal(request, wide), 421U) << host;
  }
}

TEST_F(RequestPolicy, ARefusalSaysWhatWasFoundAndExpected) {
  RequestFields request = get("/socket");
  request.hosts = {"robot.example"};
  EXPECT_EQ(refusal_line(request, local, 421),
            "Host: found 'robot.example', expected a name and the port of this page, such as '127.0.0.1:8123'");
  request.hosts = {};
  EXPECT_NE(refusal_line(request, local, 421).find("found none"), std::string::npos);
  request.hosts = {"localhost:8123"};
  request.origins = {"https://robot.example"};
  EXPECT_EQ(refusal_line(request, local, 403),
            "Origin: found 'https://robot.example', expected that of the Host, 'http://localhost:8123'");
  const std::string text = refusal_text(request, local, 403);
  EXPECT_EQ(text.find(refusal_line(request, local, 403) + "."), 0U);
  EXPECT_NE(text.find("http://127.0.0.1:8123, http://localhost:8123, http://[::1]:8123"), std::string::npos) << text;
  const std::string hostile = "http://\x1b[2J\n" + std::string(5000, 'x');
  request.origins = {hostile};
  const std::string line = refusal_line(request, local, 403);
  EXPECT_LT(line.size(), 300U);
  EXPECT_EQ(line.find_first_of("\x1b\n"), std::string::npos) << line;
}

TEST(ServerAddress, TheFirstNameIsInTheAddressOfThePage) {
  EXPECT_EQ(first_origin(local), "http://127.0.0.1:8123");
  EXPECT_EQ(first_origin(lan), "https://robot.local:8123");
  EXPECT_EQ(socket_origin(local, "localhost:8123"), "ws://localhost:8123");
  EXPECT_EQ(socket_origin(lan, "robot.local:8123"), "wss://robot.local:8123");
}

TEST_F(RequestPolicy, OnlyStopIsPosted) {
  EXPECT_EQ(action(post()), RequestAction::stop);
  RequestFields request = post();
  request.target = "/";
  EXPECT_EQ(refusal(request), 405U);
  EXPECT_EQ(refusal(get("/stop")), 405U);
  request = get("/");
  request.method = "OPTIONS";
  EXPECT_EQ(refusal(request), 405U);
}

TEST_F(RequestPolicy, StopNeedsTheTokenOnce) {
  RequestFields request = post();
  for (const std::string& value : {std::string(), std::string("Bearer"), "Bearer " + token.text() + " ",
                                   "Bearer  " + token.text(), "Basic " + token.text(), token.text()}) {
    request.authorizations = {value};
    EXPECT_EQ(refusal(request), 401U) << value;
  }
  request.authorizations = {};
  EXPECT_EQ(refusal(request), 401U);
  request.authorizations = {bearer, bearer};
  EXPECT_EQ(refusal(request), 401U);
}

TEST_F(RequestPolicy, TheWordBearerHasNoCase) {
  RequestFields request = post();
  for (const std::string word : {"bearer ", "BEARER ", "bEARER "}) {
    const std::string value = word + token.text();
    request.authorizations = {value};
    EXPECT_EQ(action(request), RequestAction::stop) << word;
  }
}

TEST_F(RequestPolicy, TheSocketIsForUpgrades) {
  RequestFields request = get("/socket");
  EXPECT_EQ(refusal(request), 426U);
  request.is_upgrade = true;
  EXPECT_EQ(action(request), RequestAction::open_socket);
  request.method = "HEAD";
  EXPECT_EQ(refusal(request), 426U);
}

TEST_F(RequestPolicy, AForeignHostLearnsNothingElse) {
  RequestFields request = get("/stop");
  request.hosts = {"evil.example"};
  request.method = "PUT";
  request.origins = {"http://evil.example"};
  EXPECT_EQ(refusal(request), 421U);
}

TEST(PathOf, IsTheTargetWithoutTheQuery) {
  EXPECT_EQ(path_of("/a/b?c?d"), "/a/b");
  EXPECT_EQ(path_of("?"), "");
  EXPECT_EQ(path_of("/"), "/");
}

TEST(ResponseHeader, HasTheFieldsThatKeepOtherPagesOut) {
  EXPECT_EQ(response_header(200, "text/css", 7, "ws://localhost:8123", true),
            "HTTP/1.1 200 OK\r\n"
            "Content-Type: text/css\r\n"
            "Content-Length: 7\r\n"
            "Connection: keep-alive\r\n"
            "Content-Security-Policy: default-src 'none'; script-src 'self'; worker-src 'self'; style-src 'self'; "
            "img-src 'self' data: blob:; connect-src 'self' ws://localhost:8123; base-uri 'none'; form-action 'none'; "
            "frame-ancestors 'none'\r\n"
            "X-Content-Type-Options: nosniff\r\n"
            "Cross-Origin-Resource-Policy: same-origin\r\n"
            "Referrer-Policy: no-referrer\r\n"
            "Cache-Control: no-store\r\n\r\n");
}

TEST(ResponseHeader, NamesWhatIsExpected) {
  const auto has = [](unsigned status, std::string_view field) {
    return response_header(status, "text/plain", 0, "", false).find(field) != std::string::npos;
  };
  EXPECT_TRUE(has(401, "\r\nWWW-Authenticate: Bearer\r\n"));
  EXPECT_TRUE(has(405, "\r\nAllow: GET, HEAD, POST\r\n"));
  EXPECT_TRUE(has(426, "\r\nUpgrade: websocket\r\n"));
  EXPECT_TRUE(has(404, "\r\nConnection: close\r\n"));
  EXPECT_TRUE(has(421, "HTTP/1.1 421 Misdirected Request\r\n"));
}

TEST_F(RequestPolicy, JoiningNeedsNoTokenWhereThereAreSeats) {
  RequestFields join = post();
  join.target = "/join";
  join.authorizations = {};
  EXPECT_EQ(refusal(join), 405U);
  join.may_join = true;
  EXPECT_EQ(action(join), RequestAction::join);
  join.origins = {"http://evil.example"};
  EXPECT_EQ(refusal(join), 403U);
  RequestFields read = get("/join");
  read.may_join = true;
  EXPECT_EQ(refusal(read), 405U);
}

}  // namespace
}  // namespace proleg::host
