"""Finds in the text what compiling hides: a file must compile alone, as it does for who builds one.

    check_includes.py SOURCE_DIR

Precompiled headers (cmake/precompiled.hpp) hide an include that is missing: a file that names what one of them declares
has to include that header, itself or through headers of the project that it includes. Sources compiled as one
(JINK_UNITY) see each other: none may use what another of its folder declares or includes and it does not.
"""

import pathlib
import re
import sys

source = pathlib.Path(sys.argv[1]).resolve()
TOP = ("planner", "config", "bridge", "sim", "tools", "tests", "examples")
# What is looked for; of a header that is not here the compiler says nothing, since the others bring it.
DECLARES = {
    "Eigen/Core": r"Eigen::",
    "Eigen/Geometry": r"Eigen::(Quaternion|AngleAxis|Isometry|Affine|Translation)|\.cross\(",
    "algorithm": r"std::(sort|stable_sort|max_element|min_element|clamp|any_of|all_of|none_of|find_if|count_if|transform)\b",
    "array": r"std::array\b",
    "atomic": r"std::atomic\b",
    "chrono": r"std::chrono\b",
    "cmath": r"std::(sqrt|hypot|sin|cos|tan|atan2|acos|asin|exp|log|log10|pow|floor|ceil|lround|isfinite|isnan|fmod)\(",
    "bit": r"std::bit_cast\b",
    "cstdio": r"std::(printf|fprintf|snprintf|fputs|FILE|fflush)\b",
    "cstdlib": r"std::(getenv|strtod|exit|abort|system)\b",
    "cstring": r"std::(memcpy|memcmp|memset|strlen|strcmp|strerror)\b",
    "condition_variable": r"std::condition_variable\b",
    "deque": r"std::deque\b",
    "filesystem": r"std::filesystem\b",
    "fstream": r"std::[io]?fstream\b",
    "functional": r"std::function\b",
    "gtest/gtest.h": r"^TEST(_F|_P)?\(",
    "iostream": r"std::(cout|cerr)\b",
    "limits": r"std::numeric_limits\b",
    "map": r"std::(multi)?map\b",
    "memory": r"std::(unique_ptr|shared_ptr|make_unique|make_shared)\b",
    "mutex": r"std::(mutex|scoped_lock|unique_lock|lock_guard)\b",
    "numeric": r"std::(accumulate|iota|inner_product)\b",
    "numbers": r"std::numbers\b",
    "optional": r"std::(optional|nullopt)\b",
    "set": r"std::(multi)?set\b",
    "span": r"std::span\b",
    "sstream": r"std::[io]?stringstream\b",
    "stdexcept": r"std::(runtime_error|invalid_argument|out_of_range|logic_error)\b",
    "string": r"std::(string|to_string)\b",
    "string_view": r"std::string_view\b",
    "thread": r"std::(jthread|thread|this_thread)\b",
    "variant": r"std::(variant|visit|get_if|holds_alternative|monostate)\b",
    "vector": r"std::vector\b",
}
# By the standard, or by what the library promises, one brings the other.
BRINGS = {"Eigen/Geometry": {"Eigen/Core"}, "Eigen/LU": {"Eigen/Core"}, "Eigen/Cholesky": {"Eigen/Core"},
          "Eigen/Eigenvalues": {"Eigen/Core"}, "string": {"string_view"}, "thread": {"stop_token"},
          "filesystem": {"string", "string_view"}, "gtest/gtest.h": {"string", "vector", "memory", "set", "map", "string_view"},
          "nlohmann/json.hpp": {"string", "vector", "map", "memory", "functional", "array", "string_view"},
          "fmt/format.h": {"string", "string_view"}, "sstream": {"string"}, "fstream": {"string"}, "iostream": {"string"},
          "stdexcept": {"string", "string_view"}, "condition_variable": {"mutex", "chrono"}, "map": set(), "mutex": {"chrono"}}


def read(file):
    text = re.sub(r"//[^\n]*", "", file.read_text())
    return text, re.findall(r'^#include\s+[<"]([^>"]+)[>"]', text, re.MULTILINE)


files = {str(f.relative_to(source)): read(f) for top in TOP for f in sorted((source / top).rglob("*")) if
         f.suffix in (".cpp", ".hpp") and "ros2" not in f.parts}


def reached(name, seen):
    """All that `name` includes, through the project's own headers."""
    for include in files[name][1]:
        for one in {include, *BRINGS.get(include, ())}:
            if one not in seen:
                seen.add(one)
                if one in files:
                    reached(one, seen)
    return seen


def code_of(name):
    """Without includes, comments, texts and the names of tests."""
    text = re.sub(r'R"\((.*?)\)"|"(\\.|[^"\\\n])*"', '""', (source / name).read_text(), flags=re.DOTALL)
    return re.sub(r"^#include.*|//.*|^TEST(_F|_P)?\(\w+, \w+", "", text, flags=re.MULTILINE)


# At the beginning of a line, since namespaces do not indent: a type, an alias, a name that is used, a function or a value.
DECLARED = re.compile(
    r"^(?:template <.*>\n)?(?:(?:constexpr|const|static|inline|\[\[\w+\]\]) )*"
    r"(?:(?:struct|class|enum class|using|namespace) (\w+)(?= |;|$)|using [\w:]*::(\w+);|"
    r"(?!return|namespace|using|struct|class|enum|template|TEST|INST|static_assert)[A-Za-z_][\w:<>,&* ()]*?[ &*](\w+)(?:\(|\[| = |\{|;))",
    re.MULTILINE)


def borrowed():
    """(source, name) where a source uses a name that only others of its folder know. A name that the source declares in
    whatever place, as a variable or a member, is not looked at."""
    code = {name: code_of(name) for name in files}
    declared = {name: {n for names in DECLARED.findall(text) for n in names if n} for name, text in code.items()}
    sees = {name: {name, *reached(name, set())} & files.keys() for name in files if name.endswith(".cpp")}
    known = {name: set().union(*(declared[h] for h in headers)) for name, headers in sees.items()}
    words = {name: set(re.findall(r"\w+", text)) for name, text in code.items()}
    for name, headers in sees.items():
        own = code[name]
        bare = set(re.findall(r"(?<![\w.:>])(?<!->)\w+", own))
        neighbours = [known[other] for other in sees if pathlib.Path(other).parent == pathlib.Path(name).parent]
        candidates = set().union(*neighbours) & bare - known[name]
        for word in sorted(candidates.difference(*(words[h] for h in headers if h != name))):
            local = rf"(?:\b(?!return|throw|else|case|new)\w+|[>&*\]]) ?[&*]*\s?\b{word}\b\s*[=;,({{\[):>]|, {word} ="
            if not re.search(local, own):
                yield name, word


def main():
    faults = [f"{name} uses {word}, which only other sources of its folder know" for name, word in borrowed()]
    for name, (text, _) in files.items():
        have = reached(name, set())
        faults += [f"{name} does not include <{header}>" for header, names in DECLARES.items()
                   if header not in have and re.search(names, text, re.MULTILINE)]
    print("\n".join(faults) or f"{len(files)} files include what they name of {len(DECLARES)} headers")
    return 1 if faults or len(files) < 100 else 0


sys.exit(main())
