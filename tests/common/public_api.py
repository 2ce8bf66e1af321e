"""Checks that docs/api.md names every public header and every public name in it, and that each of
these has a docstring: public_api.py PAGE INCLUDE... Before that it checks itself on a header with
faults."""
import pathlib
import re
import sys

SCOPE = re.compile(r"(?:^|\s)(namespace|class|struct|enum class)\s+(\w+)[^;()]*$")


def declarations(text):
    """(name, has a docstring) of what a header declares outside of private parts."""
    text = re.sub(r"^\s*#.*$|alignas\(\w+\)", "", text, flags=re.M)
    found, scopes, pending, documented, public = [], [], "", False, [True]
    depth = 0  # of function bodies and initialisers, which are skipped
    position = 0
    while position < len(text):
        if text.startswith("//", position):
            end = text.find("\n", position)
            comment = text[position:end]
            if comment.startswith("///<") and found and not depth:
                found[-1] = (found[-1][0], True)
            elif comment.startswith("///") and not depth:
                documented = True
            position = end
            continue
        c = text[position]
        position += 1
        if depth:
            depth += {"{": 1, "}": -1}.get(c, 0)
            if depth == 0 and body_ends_declaration:
                pending = ""
        elif c == "{":
            scope = SCOPE.search(pending)
            if scope:
                kind, name = scope.groups()
                if kind != "namespace" and all(public):
                    found.append((name, documented))
                scopes.append((kind, name, len(found)))
                public.append(kind != "class")
                pending, documented = "", False
            else:
                if "(" in pending or "operator" in pending:
                    note(found, pending, documented, scopes, public)
                    pending, documented, body_ends_declaration = "", False, True
                else:
                    body_ends_declaration = False
                depth = 1
        elif c == "}":
            if scopes and scopes[-1][0] == "enum class":
                note(found, pending, True, scopes, public)
            scopes.pop()
            public.pop()
            pending = ""
        elif c == ";":
            note(found, pending, documented, scopes, public)
            pending, documented = "", False
        elif c == ":" and pending.strip() in ("public", "private", "protected"):
            public[-1] = pending.strip() == "public"
            pending = ""
        else:
            pending += c
    return found


def note(found, text, documented, scopes, public):
    text = " ".join(text.split())
    if not text or not all(public) or text.startswith(("using std", "static_assert", "friend")):
        return
    if re.match(r"(class|struct) \w+$", text):  # declared ahead
        return
    text = re.sub(r"^template <.*?> ", "", text)
    text = re.sub(r"^std::function<[^=]*> (\w+).*", r"value \1", text)
    if "= delete" in text or "= default" in text or "~" in text:
        return
    if "(" in text:
        name = re.search(r"([\w~]+|operator\S+) ?\(", text).group(1)
        if scopes and name == scopes[-1][1] and "(" in text and (
                "&&" in text):  # moves
            return
    elif text.startswith("using"):
        name = text.split()[1]
    else:
        name = re.search(r"(\w+)(\[[^\]]*\])*$", re.sub(r" =.*", "", text.split(",")[0])).group(1)
    found.append((name, documented))


def faults(headers, page):
    for path, text in headers:
        if path not in page:
            yield f"{path}: not in the page"
        for name, documented in declarations(text):
            if not documented:
                yield f"{path}: {name} has no docstring"
            if not re.search(rf"\b{name}\b", page):
                yield f"{path}: {name} is not in the page"


def main():
    planted = """#pragma once
    namespace shadowcache {
    /// Documented.
    struct Documented {
        int value = 0;  ///< documented
        int silent;
        /// Documented.
        int twice(int x) const { return 2 * x; }
    };
    /// Documented.
    class Hidden {
    public:
        /// Documented.
        float absent(int x) const;
    private:
        int secret_ = 0;
    };
    }
    """
    page = "common/a.h: `Documented`, `value`, `silent`, `twice`, `Hidden`"
    wanted = ["common/a.h: silent has no docstring", "common/a.h: absent is not in the page"]
    if list(faults([("common/a.h", planted)], page)) != wanted:
        sys.exit(f"the check is wrong: {list(faults([('common/a.h', planted)], page))}")

    page, found = pathlib.Path(sys.argv[1]).read_text(), []
    for include in map(pathlib.Path, sys.argv[2:]):
        headers = [(str(f.relative_to(include)), f.read_text()) for f in sorted(include.rglob("*.h"))]
        if not headers:
            sys.exit(f"{include}: no headers")
        found += faults(headers, page)
    print("\n".join(found))
    sys.exit(1 if found else 0)


main()
