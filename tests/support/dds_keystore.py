# SPDX-License-Identifier: BSD-3-Clause
"""Keys of DDS enclaves, as SROS 2 lays them out: one certificate authority, and a folder for each enclave.

    dds_keystore.py FOLDER ENCLAVE...

Makes FOLDER/ENCLAVE with identity_ca.cert.pem, cert.pem, key.pem, permissions_ca.cert.pem, governance.p7s and
permissions.p7s. Each enclave may read and write every topic of every domain; who has no key is not let in.
"""

import pathlib
import shutil
import subprocess
import sys

GOVERNANCE = """<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance">
<domain_access_rules><domain_rule>
<domains><id_range><min>0</min><max>230</max></id_range></domains>
<allow_unauthenticated_participants>false</allow_unauthenticated_participants>
<enable_join_access_control>true</enable_join_access_control>
<discovery_protection_kind>ENCRYPT</discovery_protection_kind>
<liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>
<rtps_protection_kind>SIGN</rtps_protection_kind>
<topic_access_rules><topic_rule>
<topic_expression>*</topic_expression>
<enable_discovery_protection>true</enable_discovery_protection>
<enable_liveliness_protection>true</enable_liveliness_protection>
<enable_read_access_control>true</enable_read_access_control>
<enable_write_access_control>true</enable_write_access_control>
<metadata_protection_kind>ENCRYPT</metadata_protection_kind>
<data_protection_kind>ENCRYPT</data_protection_kind>
</topic_rule></topic_access_rules>
</domain_rule></domain_access_rules>
</dds>
"""
PERMISSIONS = """<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance">
<permissions><grant name="{name}">
<subject_name>CN={name}</subject_name>
<validity><not_before>2020-01-01T00:00:00</not_before><not_after>2100-01-01T00:00:00</not_after></validity>
<allow_rule><domains><id_range><min>0</min><max>230</max></id_range></domains>
<publish><topics><topic>*</topic></topics></publish>
<subscribe><topics><topic>*</topic></topics></subscribe></allow_rule>
<default>DENY</default>
</grant></permissions>
</dds>
"""


def openssl(*arguments):
    subprocess.run(["openssl", *map(str, arguments)], check=True, capture_output=True)


def make_key(file):
    openssl("ecparam", "-name", "prime256v1", "-genkey", "-noout", "-out", file)


def make_keystore(folder, enclaves):
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True)
    ca, ca_key = folder / "ca.cert.pem", folder / "ca.key.pem"
    make_key(ca_key)
    openssl("req", "-x509", "-new", "-key", ca_key, "-sha256", "-days", 3650, "-subj", f"/CN={folder.name} CA", "-out", ca)

    def sign(text, to):
        plain = to.with_suffix(".xml")
        plain.write_text(text)
        openssl("smime", "-sign", "-text", "-in", plain, "-out", to, "-signer", ca, "-inkey", ca_key)

    for name in enclaves:
        enclave = folder / name
        enclave.mkdir()
        make_key(enclave / "key.pem")
        request = enclave / "request.pem"
        openssl("req", "-new", "-key", enclave / "key.pem", "-sha256", "-subj", f"/CN={name}", "-out", request)
        openssl("x509", "-req", "-in", request, "-CA", ca, "-CAkey", ca_key, "-CAcreateserial", "-days", 3650, "-sha256",
                "-out", enclave / "cert.pem")
        for copy in ("identity_ca.cert.pem", "permissions_ca.cert.pem"):
            shutil.copy(ca, enclave / copy)
        sign(GOVERNANCE, enclave / "governance.p7s")
        sign(PERMISSIONS.format(name=name), enclave / "permissions.p7s")
    return folder


if __name__ == "__main__":
    make_keystore(sys.argv[1], sys.argv[2:])
