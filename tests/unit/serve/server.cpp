#include "corda/serve/server.hpp"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/core/file.hpp"
#include "support/command.hpp"
#include "support/failure.hpp"

namespace corda::serve {
namespace {

using testing::HasSubstr;
using testing::MatchesRegex;
using testing::Not;
using testing::StartsWith;

TEST(KnownHosts, AreThisMachineAndThoseOfAProxy) {
    const std::vector<std::string> others{"hub.example.org"};
    for (const char* const host : {"localhost", "localhost:8000", "LOCALHOST:1", "127.0.0.1:8000",
                                   "127.0.0.1", "[::1]:80", "hub.example.org", "Hub.Example.Org:443"})
        EXPECT_TRUE(is_known_host(host, others)) << host;
    for (const char* const host : {"", ":8000", "example.org", "localhost.example.org",
                                   "127.0.0.1.example.org", "[::2]:80", "hub.example.org.evil", "xlocalhost"})
        EXPECT_FALSE(is_known_host(host, others)) << host;
    EXPECT_FALSE(is_known_host("hub.example.org", {}));
    EXPECT_TRUE(is_known_host("hub.example.org", std::vector<std::string>{"Hub.example.org:8443"}));
}

class ServerTest : public testing::Test {
  protected:
    static Response answer(const Request& request) {
        if (request.path == "fails") throw Error(ExitCode::kUsage, "no such number");
        if (request.path == "throws") throw 1;
        std::string text = request.path + "|" + (request.is_post ? "post" : "get") + "|" + request.body;
        for (const auto& [name, value] : request.query) text += "|" + name + "=" + value;
        return text_response(200, text);
    }

    [[nodiscard]] static std::uint16_t port_of(const Server& server) {
        return static_cast<std::uint16_t>(
            std::stoi(server.address().substr(std::string("http://127.0.0.1:").size())));
    }

    /// The answer to a request of these lines.
    [[nodiscard]] std::string ask(const std::string& lines, const std::string& body = "") const {
        const Descriptor socket(::socket(AF_INET, SOCK_STREAM, 0));
        sockaddr_in place{};
        place.sin_family = AF_INET;
        place.sin_port = htons(port_of(server_));
        place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        EXPECT_EQ(::connect(socket.get(), reinterpret_cast<sockaddr*>(&place), sizeof place), 0);
        EXPECT_EQ(write_all(socket.get(), lines + "Connection: close\r\n\r\n" + body), 0);
        std::string text(1 << 16, '\0');
        std::size_t length = 0;
        for (ssize_t count = 1; count > 0; length += static_cast<std::size_t>(count))
            count = ::read(socket.get(), text.data() + length, text.size() - length);
        text.resize(length);
        return text;
    }

    [[nodiscard]] std::string get(const std::string& path,
                                  const std::string& headers = "Host: localhost\r\n") const {
        return ask("GET " + base_ + path + " HTTP/1.1\r\n" + headers);
    }

    const Server server_{{.hosts = {"hub.example.org"}}, &answer};
    const std::string base_ = server_.address().substr(server_.address().find('/', 8));
};

TEST_F(ServerTest, AddressHasARandomToken) {
    EXPECT_THAT(server_.address(), MatchesRegex("http://127\\.0\\.0\\.1:[0-9]+/[0-9a-f]{32}/"));
    const Server other({}, &answer);
    EXPECT_NE(other.address().substr(other.address().find('/', 8)), base_);
}

TEST_F(ServerTest, AnswersWhatKnowsTheToken) {
    const std::string page = get("frame/3.png?film=7&x=a%20b");
    EXPECT_THAT(page, StartsWith("HTTP/1.1 200 OK"));
    EXPECT_THAT(page, HasSubstr("frame/3.png|get||film=7|x=a b"));
    for (const char* const header :
         {"Content-Security-Policy: default-src 'none'", "X-Content-Type-Options: nosniff",
          "Referrer-Policy: no-referrer", "Cache-Control: no-store"})
        EXPECT_THAT(page, HasSubstr(header));
    EXPECT_THAT(ask("POST " + base_ + "number HTTP/1.1\r\nHost: localhost\r\nContent-Length: 4\r\n", "body"),
                HasSubstr("number|post|body"));
    std::string wrong = base_;
    wrong[5] = wrong[5] == '0' ? '1' : '0';
    for (const std::string& path :
         {std::string("/"), wrong, wrong + "state", base_.substr(0, base_.size() - 1), base_.substr(1)})
        EXPECT_THAT(ask("GET " + path + " HTTP/1.1\r\nHost: localhost\r\n"), Not(HasSubstr("200 OK")))
            << path;
}

/// A page of another site can send requests here by the browser, and its name can be made to mean this
/// machine.
TEST_F(ServerTest, RefusesOtherHostsAndOrigins) {
    EXPECT_THAT(get("", "Host: evil.example\r\n"), HasSubstr("403"));
    EXPECT_THAT(get("", ""), Not(HasSubstr("200 OK")));
    EXPECT_THAT(get("", "Host: localhost:1\r\nOrigin: http://localhost:1\r\n"), HasSubstr("200 OK"));
    for (const char* const origin : {"https://hub.example.org", "https://Hub.example.org:8443"})
        EXPECT_THAT(get("", std::string("Host: localhost:1\r\nOrigin: ") + origin + "\r\n"),
                    HasSubstr("200 OK"))
            << origin;
    for (const char* const origin :
         {"http://evil.example", "http://localhost:2", "null", "http://localhost:1.evil.example",
          "https://hub.example.org.evil.example"})
        EXPECT_THAT(get("", std::string("Host: localhost:1\r\nOrigin: ") + origin + "\r\n"), HasSubstr("403"))
            << origin;
}

TEST_F(ServerTest, RefusesMethodsAndLongBodies) {
    EXPECT_THAT(ask("DELETE " + base_ + " HTTP/1.1\r\nHost: localhost\r\n"), HasSubstr("405"));
    const std::string body((1 << 20) + 1, 'x');
    EXPECT_THAT(ask("POST " + base_ + " HTTP/1.1\r\nHost: localhost\r\nContent-Length: " +
                        std::to_string(body.size()) + "\r\n",
                    body),
                HasSubstr("413"));
    EXPECT_THAT(get("fails"), testing::AllOf(HasSubstr("400"), HasSubstr("no such number")));
}

TEST_F(ServerTest, RefusesBeforeItReadsABody) {
    // The body never comes.
    const std::string lines = " HTTP/1.1\r\nContent-Length: 1000000000\r\nHost: ";
    EXPECT_THAT(ask("POST /" + std::string(32, '0') + "/number" + lines + "localhost\r\n"), HasSubstr("404"));
    EXPECT_THAT(ask("POST " + base_ + "number" + lines + "evil.example\r\n"), HasSubstr("403"));
}

TEST_F(ServerTest, OutlivesAnythingThatIsThrown) {
    EXPECT_EQ(get("throws"), "");
    EXPECT_THAT(get("after"), HasSubstr("200 OK"));
}

/// A page that is open finds the next program at its address.
TEST_F(ServerTest, KeepsTheTokenOfAPort) {
    const test::ScratchFolder folder;
    ::setenv("XDG_RUNTIME_DIR", folder.path().c_str(), 1);
    const std::uint16_t port = port_of(server_);
    const std::string token = token_of_port(port);
    EXPECT_TRUE(is_token(token));
    EXPECT_EQ(token_of_port(port), token);
    EXPECT_NE(token_of_port(0), token_of_port(0));
    EXPECT_NE(token_of_port(static_cast<std::uint16_t>(port ^ 1U)), token);
    const std::string path = folder.path() + "/" + folder.files().front();
    EXPECT_EQ(std::filesystem::status(path).permissions(),
              std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
    // Another user may have read or written what others can.
    for (const std::string& file : folder.files())
        std::filesystem::permissions(folder.path() + "/" + file, std::filesystem::perms::others_read,
                                     std::filesystem::perm_options::add);
    EXPECT_NE(token_of_port(port), token);
    ::unsetenv("XDG_RUNTIME_DIR");
}

TEST_F(ServerTest, HasTheTokenThatIsGiven) {
    const Server given({.token = "a-token_of_20_letters"}, &answer);
    EXPECT_THAT(given.address(), testing::EndsWith("/a-token_of_20_letters/"));
    for (const char* const token : {"short", "a token of 20 letters", "a/token/of/20/letters"})
        EXPECT_EQ(test::code_of([&] { const Server none({.token = token}, &answer); }), ExitCode::kUsage);
}

TEST_F(ServerTest, ListensWhereItIsTold) {
    const Server all({.hosts = {"Box.example:8443", "10.0.0.2"}, .bind = "0.0.0.0"}, &answer);
    EXPECT_THAT(all.address(), StartsWith("http://127.0.0.1:"));
    const std::string end = all.address().substr(std::string("http://127.0.0.1").size());
    EXPECT_THAT(all.other_addresses(),
                testing::ElementsAre("http://box.example" + end, "http://10.0.0.2" + end));
    const Server v6({.bind = "::1"}, &answer);
    EXPECT_THAT(v6.address(), StartsWith("http://[::1]:"));
    const Server other({.hosts = {"box.example"}, .bind = "127.0.0.2"}, &answer);
    EXPECT_THAT(other.address(), StartsWith("http://127.0.0.2:"));
    EXPECT_THAT(other.other_addresses(), testing::IsEmpty());  // nobody else reaches it
    for (const char* const bind : {"localhost", "1.2.3", "", "0.0.0.0:80"})
        EXPECT_EQ(test::code_of([&] { const Server none({.bind = bind}, &answer); }), ExitCode::kUsage);
    for (const char* const host : {"", "a b", "http://a", "a;script-src *", "*.example"})
        EXPECT_EQ(test::code_of([&] { const Server none({.hosts = {host}}, &answer); }), ExitCode::kUsage)
            << host;
}

TEST_F(ServerTest, IsShownInFramesOfItsHosts) {
    EXPECT_THAT(get(""),
                HasSubstr("frame-ancestors 'self' http://hub.example.org:* https://hub.example.org:*\r\n"));
}

TEST_F(ServerTest, NamesAPortThatIsTaken) {
    const test::Failure failure =
        test::failure_of([&] { const Server other({.port = port_of(server_)}, &answer); });
    EXPECT_EQ(failure.code, ExitCode::kIo);
    EXPECT_THAT(failure.message, HasSubstr("Address already in use; give another --port"));
}

}  // namespace
}  // namespace corda::serve
