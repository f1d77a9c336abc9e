#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Compares the ROS 2 package's .msg files with bridge/dds/idl, field by field: names, order, types.

    check_ros_messages.py PROJECT_ROOT
"""
import pathlib
import re
import sys

PRIMITIVES = {
    "bool": "boolean", "byte": "octet", "uint8": "octet", "char": "octet", "int16": "short", "uint16": "unsigned short",
    "int32": "long", "uint32": "unsigned long", "int64": "long long", "uint64": "unsigned long long",
    "float32": "float", "float64": "double", "string": "string",
}


def idl_structs(text):
    """{"package::msg::dds_::Name_": [(type, name), ...]}; arrays as type[N], unbounded sequences as type[]."""
    text = re.sub(r"//[^\n]*", "", text)
    structs = {}
    package = None
    for module, name, body in re.findall(r"module (\w+) \{ module msg|struct (\w+) \{(.*?)\};", text, re.S):
        if module:
            package = module
            continue
        fields = []
        for field in filter(None, (part.strip() for part in body.split(";"))):
            kind, variable, size = re.fullmatch(r"(.+?)\s+(\w+)(\[\d+\])?", field, re.S).groups()
            sequence = re.fullmatch(r"sequence<(.+)>", kind)
            fields.append(((sequence[1] + "[]") if sequence else kind + (size or ""), variable))
        structs[f"{package}::msg::dds_::{name}"] = fields
    return structs


def msg_fields(text, package):
    fields = []
    for line in text.splitlines():
        line = line.split("#")[0].strip()
        if not line or "=" in line:  # constants are not on the wire
            continue
        kind, variable = line.split()
        kind, brackets = re.fullmatch(r"([\w/]+)((?:\[\d*\])?)", kind).groups()
        if kind in PRIMITIVES:
            kind = PRIMITIVES[kind]
        else:
            owner, name = kind.split("/") if "/" in kind else (package, kind)
            kind = f"{owner}::msg::dds_::{name}_"
        fields.append((kind + brackets, variable))
    return fields


def main():
    root = pathlib.Path(sys.argv[1])
    package = root / "bridge/dds/ros2/jink_msgs"
    structs = {}
    for file in sorted((root / "bridge/dds/idl").glob("*.idl")):
        structs.update(idl_structs(file.read_text()))
    listed = set(re.findall(r"msg/\w+\.msg", (package / "CMakeLists.txt").read_text()))
    faults = []
    messages = sorted((package / "msg").glob("*.msg"))
    for file in messages:
        fields = msg_fields(file.read_text(), "jink_msgs")
        struct = structs.get(f"jink_msgs::msg::dds_::{file.stem}_")
        if struct != fields:
            faults.append(f"{file.name}: {fields}\n  but bridge/dds/idl has {struct}")
        if f"msg/{file.name}" not in listed:
            faults.append(f"{file.name} is not in the package's CMakeLists.txt")
    faults += [f"{name} is listed but not there" for name in sorted(listed) if not (package / name).exists()]
    for name in structs:
        stem = re.fullmatch(r"jink_msgs::msg::dds_::(\w+)_", name)
        if stem and not (package / "msg" / f"{stem[1]}.msg").exists():
            faults.append(f"{name} has no {stem[1]}.msg")
    if len(messages) < 2:
        faults.append("no messages found")
    print("\n".join(faults) or f"{len(messages)} messages agree with bridge/dds/idl")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
