# SPDX-License-Identifier: Apache-2.0
"""Chromium without a window, by the Chrome DevTools Protocol: one tab, its keys, its fingers, its pictures."""
import atexit, base64, itertools, json, re, shutil, subprocess, tempfile, threading, time
from serve_client import Socket

KEYS = {"Tab": 9, "Enter": 13, "Escape": 27, " ": 32, "ArrowRight": 39, "ArrowUp": 38, "Home": 36, "End": 35, "+": 187, "-": 189}


def chromium():
    return next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)


class Tab:
    """A tab of a browser of its own. `errors` has what the page's scripts complained of."""

    def __init__(self, width, height, touch=False, dark=False, flags=()):
        self.folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        self.process = subprocess.Popen(
            [chromium(), "--headless=new", "--no-sandbox", "--remote-debugging-port=0", "--enable-unsafe-swiftshader",
             f"--user-data-dir={self.folder.name}", "--no-first-run", *flags, "about:blank"],
            stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
        atexit.register(self.process.kill)  # a test that fails leaves no browser behind
        while not (at := re.search(r"ws://127\.0\.0\.1:(\d+)(\S+)", self.process.stderr.readline())):
            continue
        threading.Thread(target=self.process.stderr.read, daemon=True).start()
        self.socket = Socket(int(at[1]), at[2])
        self.numbers, self.answers, self.errors, self.session = itertools.count(1), {}, [], None
        threading.Thread(target=self.read, daemon=True).start()
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime"):
            self.call(f"{domain}.enable")
        self.resize(width, height, touch)
        self.call("Emulation.setTouchEmulationEnabled", enabled=touch)
        self.call("Emulation.setEmulatedMedia",
                  features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])

    def read(self):
        try:
            while True:
                message = self.socket.message()
                if "id" in message:
                    self.answers[message["id"]] = message
                elif message["method"] == "Runtime.exceptionThrown":
                    self.errors.append(message["params"]["exceptionDetails"]["exception"].get("description", "?"))
        except OSError:
            return

    def call(self, method, **given):
        return self.answer(self.send(method, **given))

    def send(self, method, **given):
        """Asks without waiting; `answer` waits for what the number returned stands for."""
        number = next(self.numbers)
        message = {"id": number, "method": method, "params": given}
        if self.session:
            message["sessionId"] = self.session
        self.socket.send(json.dumps(message))
        return number

    def answer(self, number):
        end = time.monotonic() + 60
        while number not in self.answers and time.monotonic() < end:
            time.sleep(0.002)
        answer = self.answers.pop(number)
        if "error" in answer:
            raise RuntimeError(f"command {number}: {answer['error']}")
        return answer["result"]

    def see(self, expression):
        """The value of a JavaScript expression in the page."""
        answer = self.call("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(answer["exceptionDetails"]["exception"].get("description", expression))
        return answer["result"].get("value")

    def until(self, expression, seconds=30.0):
        end = time.monotonic() + seconds
        while not (seen := self.see(expression)) and time.monotonic() < end:
            time.sleep(0.05)
        return seen

    def key(self, key, hold_s=0.0):
        text = {"Enter": "\r", "Tab": "", "Escape": "", "ArrowRight": "", "ArrowUp": "", "Home": "", "End": ""}.get(key, key)
        given = {"key": key, "windowsVirtualKeyCode": KEYS.get(key, ord(key[0].upper()))}
        self.call("Input.dispatchKeyEvent", type="keyDown" if text else "rawKeyDown", text=text, **given)
        time.sleep(hold_s)
        self.call("Input.dispatchKeyEvent", type="keyUp", **given)

    def tab_to(self, selector):
        """The tabulator key, until what is wanted has the focus; False where it never gets it."""
        for _ in range(120):
            if self.see(f"!!document.activeElement?.matches({json.dumps(selector)})"):
                return True
            self.key("Tab")
        return False

    def touch(self, selector, hold_s=0.0):
        """A finger on the middle of an element, brought into view as a hand would scroll it, once it may be pressed and rests."""
        x, y = self.see(f"""(async () => {{
            const frame = () => new Promise((drawn) => requestAnimationFrame(drawn));
            const middle = () => {{ const box = document.querySelector({json.dumps(selector)}).getBoundingClientRect();
                return [box.x + box.width / 2, box.y + box.height / 2]; }};
            document.querySelector({json.dumps(selector)}).scrollIntoView({{ block: "center" }});
            let before = [NaN, NaN], now = middle();
            while (before[0] !== now[0] || before[1] !== now[1] || document.querySelector({json.dumps(selector)}).disabled) {{
                await frame(); await frame();
                before = now; now = middle();
            }}
            return now; }})()""")
        down = self.send("Input.dispatchTouchEvent", type="touchStart", touchPoints=[{"x": x, "y": y}])
        if hold_s:
            self.answer(down)
            time.sleep(hold_s)
        # A tap's end does not wait for the page: a page that draws for half a second would make it a long press.
        up = self.send("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])
        if not hold_s:
            self.answer(down)
        self.answer(up)
        time.sleep(0.05)

    def press(self, selector, hold_s):
        """The mouse on the middle of an element, which then gets the focus."""
        x, y = self.see(f"""(() => {{ const one = document.querySelector({json.dumps(selector)});
            one.scrollIntoView({{ block: "center" }}); const box = one.getBoundingClientRect();
            return [box.x + box.width / 2, box.y + box.height / 2]; }})()""")
        for kind in ("mousePressed", "mouseReleased"):
            self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)
            time.sleep(hold_s if kind == "mousePressed" else 0.0)

    def draw(self, selector, places):
        """A finger along places of an element, each a share of its width and of its height."""
        x, y, width, height = self.see(f"""(() => {{ const box = document.querySelector({json.dumps(selector)});
            box.scrollIntoView({{ block: "center" }}); const at = box.getBoundingClientRect();
            return [at.x, at.y, at.width, at.height]; }})()""")
        for i, (along, down) in enumerate(places):
            self.call("Input.dispatchTouchEvent", type="touchMove" if i else "touchStart",
                      touchPoints=[{"x": x + along * width, "y": y + down * height}])
        self.call("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])

    def resize(self, width, height, touch=False):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=touch)

    def picture(self, file):
        data = self.call("Page.captureScreenshot", format="png")["data"]
        with open(file, "wb") as out:
            out.write(base64.b64decode(data))

    def close(self):
        self.process.terminate()
        self.process.wait(20)
        self.folder.cleanup()
