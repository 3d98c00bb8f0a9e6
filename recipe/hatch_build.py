"""Metadata for the package index: addresses of the project, and the README with absolute links."""

import re
from pathlib import Path
from typing import Any

from hatchling.metadata.plugin.interface import MetadataHookInterface


def absolute_links(text: str, repository: str) -> str:
    """Return a page with the addresses of the files of the repository, for its links to them."""
    link = re.compile(r"(!?)(\[[^]]*\])\((?![a-z]+:|#)([^)]+)\)")
    kinds = {"!": "raw", "": "blob"}
    return link.sub(lambda m: f"{m[1]}{m[2]}({repository}/{kinds[m[1]]}/HEAD/{m[3]})", text)


class CustomMetadataHook(MetadataHookInterface):
    """The addresses that hang on that of the repository; none while it is not set."""

    def update(self, metadata: dict[str, Any]) -> None:
        """Fill in `readme` and `urls`."""
        text = (Path(self.root) / "README.md").read_text(encoding="utf-8")
        if repository := self.config["repository"].rstrip("/"):
            text = absolute_links(text, repository)
            metadata["urls"] = {
                "Repository": repository,
                "Documentation": f"{repository}/blob/HEAD/docs/index.md",
                "Changelog": f"{repository}/blob/HEAD/CHANGELOG.md",
                "Issues": f"{repository}/issues",
            }
        metadata["readme"] = {"content-type": "text/markdown", "text": text}
