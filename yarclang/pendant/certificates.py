"""Self-signed TLS certificates, for users without a certificate of their own."""

from __future__ import annotations

import contextlib
import ipaddress
import os
import socket
from datetime import UTC, datetime, timedelta
from pathlib import Path

from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

from yarclang.files import reason_of
from yarclang.runtime.actions import Trouble

_LASTS = timedelta(days=397)
"""Validity of a certificate. Browsers reject longer ones."""

_RENEWED = timedelta(days=30)


def self_signed(folder: Path, names: frozenset[str]) -> tuple[Path, Path, str]:
    """Return the files of a self-signed certificate and its key. A new certificate is created if there is
    none in the folder, or if it is for other names or expires soon.

    Args:
        folder: folder in which both files are stored, readable only for the system user of this process.
        names: host names and addresses of this server.

    Returns:
        Three values: the certificate's file, the key's file, and the SHA-256 fingerprint by which users
            recognize the certificate.

    Raises:
        Trouble: the files can't be written.
    """
    certificate, key = folder / "certificate.pem", folder / "key.pem"
    wanted = frozenset({*names, "localhost", "127.0.0.1", socket.gethostname().lower()})
    created = _current(certificate)
    if created is None or not key.exists() or not wanted <= _names(created) or _ends_soon(created):
        try:
            created = _make(certificate, key, sorted(wanted))
        except OSError as error:
            reason = reason_of(error)
            raise Trouble(
                f"{folder} can't be written: {reason}", "make room, or give --data FOLDER", ""
            ) from None
    print_ = created.fingerprint(hashes.SHA256()).hex(":").upper()
    return certificate, key, print_


def _make(certificate: Path, key: Path, names: list[str]) -> x509.Certificate:
    secret = ec.generate_private_key(ec.SECP256R1())
    called = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, "YARC pendant")])
    now = datetime.now(UTC)
    builder = (
        x509.CertificateBuilder()
        .subject_name(called)
        .issuer_name(called)
        .public_key(secret.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - timedelta(days=1))
        .not_valid_after(now + _LASTS)
        .add_extension(x509.SubjectAlternativeName([_name(one) for one in names]), critical=False)
        .add_extension(x509.BasicConstraints(ca=False, path_length=None), critical=True)
        .add_extension(x509.ExtendedKeyUsage([ExtendedKeyUsageOID.SERVER_AUTH]), critical=False)
        .sign(secret, hashes.SHA256())
    )
    kept = secret.private_bytes(
        serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, serialization.NoEncryption()
    )
    _write(key, kept)
    _write(certificate, builder.public_bytes(serialization.Encoding.PEM))
    return builder


def _write(place: Path, content: bytes) -> None:
    place.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    with contextlib.suppress(FileNotFoundError):
        place.unlink()
    with os.fdopen(os.open(place, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "wb") as file:
        file.write(content)


def _current(certificate: Path) -> x509.Certificate | None:
    try:
        return x509.load_pem_x509_certificate(certificate.read_bytes())
    except (OSError, ValueError):
        return None


def _names(certificate: x509.Certificate) -> frozenset[str]:
    try:
        found = certificate.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    except x509.ExtensionNotFound:
        return frozenset()
    return frozenset(str(one.value) for one in found)


def _ends_soon(certificate: x509.Certificate) -> bool:
    return certificate.not_valid_after_utc - datetime.now(UTC) < _RENEWED


def _name(text: str) -> x509.GeneralName:
    try:
        return x509.IPAddress(ipaddress.ip_address(text))
    except ValueError:
        return x509.DNSName(text)
