"""Fixtures: `yarc pendant` in a process of its own, and a minimal client of its API."""

import http.cookiejar
import json
import re
import signal
import subprocess
import sys
import urllib.error
import urllib.request
from contextlib import contextmanager

PASSWORD, PIN = "correct horse", "4711"
PROGRAM = "P0010 MOVEJ 20 0 0 0 30 0 [6] (deg,s)\nP0020 MOVEJ HOME [6] (deg,s)\n"


class Api:
    """Client that sends requests with the cookie of its session."""

    def __init__(self, url):
        self.url = url.rstrip("/")
        self.jar = http.cookiejar.CookieJar()
        self._opener = urllib.request.build_opener(urllib.request.HTTPCookieProcessor(self.jar))

    def call(self, method, path, body=None, status=200):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.url + path, data, method=method)
        try:
            with self._opener.open(request, timeout=60) as answer:
                found, told = answer.status, json.load(answer)
        except urllib.error.HTTPError as refused:
            with refused:
                found, told = refused.code, json.load(refused)
        assert found == status, (path, found, told)
        return told

    def order(self, word, **fields):
        return self.call("POST", f"/api/orders/{word}", fields)

    def socket(self, path):
        from websockets.sync.client import connect

        cookie = "; ".join(f"{one.name}={one.value}" for one in self.jar)
        return connect("ws" + self.url.removeprefix("http") + path, additional_headers={"Cookie": cookie})


@contextmanager
def serving(folder, *options, robot="INDUSTRIAL6", own=True):
    """Serve a pendant in a process of its own. Yield its address, the token of the one-time link (empty if
    there is a user already), and the process. With `own`, the pendant has a simulator of its own.
    """
    script = "from yarclang.cli.yarc import main; main()"
    command = [sys.executable, "-c", script, "pendant", "--robot", robot, "--port", "0"]
    command += ["--no-log"] if own else []
    command += ["--folder", str(folder), "--data", str(folder / "data"), *options]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    try:
        told = ""
        while not (found := re.search(r"the pendant of .*: (\S+)\n", told)):
            line = process.stdout.readline()
            assert line, told
            told += line
        token = ""
        if not (folder / "data" / "known").exists():
            token = process.stdout.readline().rpartition("first=")[2].strip()
            (folder / "data" / "known").touch()
        yield found[1], token, process
    finally:
        process.send_signal(signal.SIGTERM)
        try:
            process.wait(30)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        process.stdout.close()


def first(url, token, name="anna"):
    """Create the first user, and return a client that is logged in as this user."""
    api = Api(url)
    api.call("POST", "/api/first", {"token": token, "user": name, "password": PASSWORD, "pin": PIN})
    return api
