"""The server of a study: its own files to its own page, one simulation at a time, and nothing else to anyone."""

import http.client
import json
import socket
import threading

import pytest

from shipcosim.errors import Problem, ShipcosimError
from shipcosim.report.study.server import study_server

OURS = {"X-Shipcosim": "run"}


class Simulations:
    """Leaves a page for each run; run 2 cannot be simulated, run 3 waits until it is let go, run 4 has a fault."""

    def __init__(self, folder):
        self.folder, self.asked = folder, []
        self.begun, self.may_end = threading.Event(), threading.Event()

    def __call__(self, run):
        self.asked.append(run)
        if run == 2:
            raise ShipcosimError(
                Problem("vessel", "step to 312.4 s failed.", "Choose a shorter step.")
            )
        if run == 3:
            self.begun.set()
            assert self.may_end.wait(120.0)
        if run == 4:
            raise RuntimeError("not foreseen")
        if run != 5:
            (self.folder / f"run-{run}").mkdir()
            (self.folder / f"run-{run}" / "report.html").write_text(f"<title>run {run}</title>")


@pytest.fixture
def simulations(tmp_path):
    folder = tmp_path / "results" / "weather"
    folder.mkdir(parents=True)
    (folder / "report.html").write_text("<title>study</title>")
    (folder / "runs.csv").write_text("run\n1\n")
    (folder / ".secret.html").write_text("hidden")
    (folder / "key.pem").write_text("secret")
    (tmp_path / "results" / "other.html").write_text("outside")
    (folder / "link.html").symlink_to(tmp_path / "results" / "other.html")
    (folder / "run-9").symlink_to(tmp_path / "results", target_is_directory=True)
    return Simulations(folder)


@pytest.fixture
def server(simulations):
    made = study_server(simulations.folder, [1, 2, 3, 4, 5, 6], simulations)
    # It looks often whether it is to end: by itself it would every half a second, for each of seventy tests.
    thread = threading.Thread(target=made.serve_forever, args=(0.02,), daemon=True)
    thread.start()
    yield made
    made.shutdown()
    made.server_close()
    thread.join()


@pytest.fixture
def ask(server):
    """Function from a method, a path and headers to status and body."""

    def send(method, path, headers=None):
        connection = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=120.0)
        connection.putrequest(method, path, skip_host="Host" in (headers or {}))
        for name, value in (headers or {}).items():
            connection.putheader(name, value)
        connection.endheaders()
        answer = connection.getresponse()
        return answer.status, answer.read().decode()

    return send


def test_page_and_tables_are_served_and_runs_with_a_page_are_listed(ask):
    assert ask("GET", "/") == ask("GET", "/report.html") == (200, "<title>study</title>")
    assert ask("GET", "/runs.csv") == (200, "run\n1\n")
    assert ask("HEAD", "/runs.csv") == (200, "")
    assert json.loads(ask("GET", "/study-server")[1]) == {"pages": []}
    assert ask("POST", "/run/1", OURS)[0] == 200
    assert json.loads(ask("GET", "/study-server")[1]) == {"pages": [1]}


def test_run_is_simulated_once_and_its_page_served(ask, simulations):
    for _ in range(2):
        status, body = ask("POST", "/run/1", OURS)
        assert (status, json.loads(body)) == (200, {"page": "run-1/report.html"})
    assert simulations.asked == [1]
    assert ask("GET", "/run-1/report.html") == (200, "<title>run 1</title>")


def test_errors_are_told_and_the_server_stays(ask):
    status, body = ask("POST", "/run/2", OURS)
    assert status == 500 and "vessel: step to 312.4 s failed." in json.loads(body)["error"]
    status, body = ask("POST", "/run/4", OURS)
    assert status == 500 and "RuntimeError: not foreseen" in json.loads(body)["error"]
    status, body = ask("POST", "/run/5", OURS)
    assert status == 500 and "left no page" in json.loads(body)["error"]
    assert ask("POST", "/run/6", OURS)[0] == 200


def test_a_study_that_has_gone_is_not_made_again(ask, simulations):
    simulations.folder.rename(simulations.folder.with_name("elsewhere"))
    status, body = ask("POST", "/run/1", OURS)
    assert status == 500 and "has been moved or removed" in json.loads(body)["error"]
    assert ask("GET", "/")[0] == 404 and not simulations.folder.exists()


def test_one_simulation_at_a_time_while_files_are_served(ask, simulations):
    first = []
    thread = threading.Thread(target=lambda: first.append(ask("POST", "/run/3", OURS)))
    thread.start()
    assert simulations.begun.wait(120.0)
    status, body = ask("POST", "/run/1", OURS)
    assert status == 409 and "one at a time" in json.loads(body)["error"]
    assert ask("GET", "/runs.csv")[0] == 200
    simulations.may_end.set()
    thread.join()
    assert first[0][0] == 200 and simulations.asked == [3]
    assert ask("POST", "/run/1", OURS)[0] == 200


@pytest.mark.parametrize(
    "path",
    [
        "/../other.html",
        "/..%2fother.html",
        "/%2e%2e/other.html",
        "/run-1/../../other.html",
        "/run-1/..%2f..%2fother.html",
        "//etc/passwd",
        "/%2fetc%2fpasswd",
        "/..\\other.html",
        "/..%5cother.html",
        "/report.html%00.csv",
        "/link.html",
        "/run-9/other.html",
        "/.secret.html",
        "/key.pem",
        "/run-1",
        "/run-1/",
        "/a/b/report.html",
        "/%ff%fe",
        "/C:/report.html",
        "http://127.0.0.1/../other.html",
    ],
)
def test_nothing_outside_of_the_folder_and_no_other_kind_of_file_is_served(ask, path):
    status, body = ask("GET", path)
    assert (
        status in (403, 404)
        and "outside" not in body
        and "hidden" not in body
        and "secret" not in body
    )


@pytest.mark.parametrize(
    "path",
    [
        "/run/0",
        "/run/7",
        "/run/-1",
        "/run/1.0",
        "/run/01x",
        "/run/99999999999999999999",
        "/run/%31",
        "/run/1?x=1",
        "/run/",
        "/",
    ],
)
def test_only_runs_of_the_study_are_simulated(ask, simulations, path):
    assert ask("POST", path, OURS)[0] == 404 and simulations.asked == []


@pytest.mark.parametrize(
    "headers",
    [
        {},
        {"X-Shipcosim": "yes"},
        {"X-Shipcosim": "run", "Origin": "http://evil.example"},
        {"X-Shipcosim": "run", "Origin": "null"},
    ],
)
def test_pages_of_other_origins_cannot_start_a_simulation(ask, simulations, headers):
    assert ask("POST", "/run/1", headers)[0] == 403 and simulations.asked == []


def test_page_of_this_server_can(ask, server):
    assert ask("POST", "/run/1", OURS | {"Origin": server.url.rstrip("/")})[0] == 200


def test_a_browser_that_asks_first_is_not_told_that_others_may(ask):
    status, body = ask(
        "OPTIONS",
        "/run/1",
        {"Origin": "http://evil.example", "Access-Control-Request-Method": "POST"},
    )
    assert status == 501 and "Access-Control-Allow" not in body


@pytest.mark.parametrize(
    "host", ["evil.example", "evil.example:{port}", "127.0.0.1", "127.0.0.1:1", ""]
)
@pytest.mark.parametrize(
    ("method", "path"), [("GET", "/"), ("GET", "/study-server"), ("POST", "/run/1")]
)
def test_names_of_other_sites_that_point_here_are_refused(
    ask, server, simulations, host, method, path
):
    headers = {"Host": host.format(port=server.server_port), **OURS}
    assert ask(method, path, headers)[0] == 403 and simulations.asked == []


@pytest.mark.parametrize("method", ["PUT", "DELETE", "PATCH", "TRACE", "CONNECT"])
def test_other_methods_are_refused(ask, method):
    assert ask(method, "/report.html")[0] == 501


@pytest.mark.parametrize(
    "sent",
    [
        b"GET /" + b"a" * 100_000 + b" HTTP/1.1\r\n\r\n",
        b"POST /run/1 HTTP/1.1\r\nHost: x\r\nContent-Length: 99999999999\r\n\r\n",
        b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03\r\n\r\n",
        b"GET / HTTP/9.9\r\n\r\n",
        b"GET / HTTP/1.1\r\n" + b"X-A: b\r\n" * 500 + b"\r\n",
        b"GET / HTTP/1.1\r\nHost: %h\r\nHost: evil.example\r\n\r\n",
        b"GET http://evil.example/ HTTP/1.1\r\nHost: %h\r\n\r\n",
    ],
)
def test_nonsense_is_refused_and_the_server_stays(ask, server, simulations, sent):
    with socket.create_connection(("127.0.0.1", server.server_port), timeout=120.0) as connection:
        connection.sendall(sent.replace(b"%h", f"127.0.0.1:{server.server_port}".encode()))
        answer = connection.recv(4096)
    assert answer.split(b" ")[1:2] != [b"200"] and simulations.asked == []
    assert ask("GET", "/")[0] == 200


@pytest.mark.parametrize("kind", ["files", "simulations"])
def test_two_hundred_requests_at_once_are_answered_or_refused(server, simulations, kind):
    (simulations.folder / "report.html").write_bytes(b"x" * 1_000_000)
    together, statuses = threading.Barrier(200), []

    def ask(number):
        together.wait(60.0)
        connection = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=20.0)
        method, path = ("GET", "/") if kind == "files" or number % 2 else ("POST", "/run/1")
        connection.request(method, path, headers=OURS)
        answer = connection.getresponse()
        if len(answer.read()) == int(answer.headers["Content-Length"]):
            statuses.append(answer.status)

    threads = [threading.Thread(target=ask, args=(number,)) for number in range(200)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(statuses) == 200 and set(statuses) <= {200, 409}


def test_only_this_machine_is_answered(server):
    assert server.server_address[0] == "127.0.0.1"


def test_answers_tell_browsers_to_keep_to_this_server(server):
    connection = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=120.0)
    connection.request("GET", "/")
    answer = connection.getresponse()
    policy = answer.headers["Content-Security-Policy"]
    assert "default-src 'none'" in policy and "frame-ancestors 'none'" in policy
    assert answer.headers["X-Content-Type-Options"] == "nosniff"
    assert answer.headers["Cross-Origin-Resource-Policy"] == "same-origin"


def test_without_a_page_or_with_a_port_that_is_taken_it_says_so(server, simulations, tmp_path):
    with pytest.raises(ShipcosimError, match=r"no report\.html"):
        study_server(tmp_path, [1], simulations)
    for port in (server.server_port, 70_000):
        with pytest.raises(ShipcosimError, match=f"Port {port} cannot be used"):
            study_server(simulations.folder, [1], simulations, port)
