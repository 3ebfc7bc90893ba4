// The page that documents the API, made from the OpenAPI document.

import { h, put } from "/dom.js";

const CLIENT = `import http.cookiejar, json, time, urllib.error, urllib.request

HOST = "http://localhost:8080"
opener = urllib.request.build_opener(urllib.request.HTTPCookieProcessor(http.cookiejar.CookieJar()))

def call(method, path, body=None):
    data = None if body is None else json.dumps(body).encode()
    request = urllib.request.Request(HOST + path, data, {"content-type": "application/json"}, method=method)
    try:
        with opener.open(request) as answer:
            return json.load(answer)
    except urllib.error.HTTPError as refused:
        told = json.load(refused)
        raise SystemExit(f"{told['error']}: {told.get('help', '')}")

call("POST", "/api/login", {"user": "anna", "password": "correct horse"})
print(call("POST", "/api/control")["what"])
loaded = call("POST", "/api/orders/load", {"file": "bend.yarc", "approach": True})
for finding in loaded["findings"]:
    print(finding["severity"], finding["code"], finding["message"])
if loaded["program"]:
    number = loaded["program"]["number"]
    print("takes", loaded["program"]["takes"]["duration_s"], "s")
    ended = call("POST", "/api/orders/run", {"program": number, "approach": True})
    print("done" if ended["well"] else ended["what"])
status = call("POST", "/api/orders/status", {})
print(status["state"], {joint["name"]: joint["position"] for joint in status["joints"]})
call("POST", "/api/control/give", {})
call("POST", "/api/logout")
`;

function name(schema) {
  if (!schema) return "";
  if (schema.$ref) return schema.$ref.split("/").pop();
  if (schema.anyOf) return schema.anyOf.map(name).join(" or ");
  if (schema.type === "array") return `list of ${name(schema.items ?? schema.prefixItems?.[0] ?? {}) || "values"}`;
  if (schema.const !== undefined) return JSON.stringify(schema.const);
  if (schema.enum) return schema.enum.map((one) => JSON.stringify(one)).join(" or ");
  return schema.type === "object" ? "object" : (schema.type ?? "any");
}

function linked(schema) {
  const shown = name(schema);
  return schema?.$ref ? h("a", { href: `#${shown}` }, shown) : shown;
}

function paragraphs(text) {
  return text.split(/\n\n+/).map((one) => h("p", {}, one.replaceAll("**", "").trim()));
}

const place = document.getElementById("document");
const api = await (await fetch("/api/openapi.json")).json();
const content = (one) => one?.content?.["application/json"]?.schema;

put(
  place,
  h("h1", {}, api.info.title, " ", h("small", {}, api.info.version)),
  paragraphs(api.info.description),
  h("p", {}, "The same for programs: ", h("a", { href: "/api/openapi.json" }, "openapi.json"), ". What isn't done is answered by ", h("a", { href: "#Denied" }, "Denied"), ", with the status 400 (not understood), 401 (not logged in), 403 (not allowed), 409 (not possible now) or 429 (too many attempts)."),
  h("h2", {}, "A client of 30 lines"),
  h("pre", {}, CLIENT),
  h("h2", {}, "Requests"),
  h("table", {}, h("thead", {}, h("tr", {}, ["Request", "What it does", "Takes", "Answers", "Who may"].map((one) => h("th", { scope: "col" }, one)))),
    h("tbody", {}, Object.entries(api.paths).flatMap(([path, methods]) =>
      Object.entries(methods).map(([method, one]) =>
        h("tr", {}, h("th", { scope: "row" }, `${method.toUpperCase()} ${path}`), h("td", {}, one.summary), h("td", {}, linked(content(one.requestBody))), h("td", {}, linked(content(one.responses["200"]))), h("td", {}, one.description)))))),
  h("h2", {}, "Messages"),
  Object.entries(api.components.schemas).map(([title, schema]) =>
    h("section", { id: title }, h("h3", {}, title), paragraphs(schema.description ?? ""),
      schema.properties && h("dl", {}, Object.entries(schema.properties).flatMap(([key, field]) => [
        h("dt", {}, key, (schema.required ?? []).includes(key) ? "" : " (may be left out)"),
        h("dd", {}, linked(field.anyOf ? field.anyOf.find((one) => one.$ref) ?? field : field), field.description ? `: ${field.description}` : ""),
      ])))),
);
if (location.hash) document.getElementById(location.hash.slice(1))?.scrollIntoView();
