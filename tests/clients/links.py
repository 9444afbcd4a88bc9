"""Whether all links of a folder of HTML lead somewhere: files that are there, places that are in them. Usage: links.py FOLDER"""

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class Page(HTMLParser):
    """The links of a page and the places in it."""

    def __init__(self, text):
        super().__init__()
        self.links, self.places = [], set()
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        for name, value in attrs:
            if name == "id" or (tag == "a" and name == "name"):
                self.places.add(value)
            elif name in ("href", "src") and value:
                self.links.append(value)


def main(folder):
    folder = Path(folder).resolve()
    # What is printed is all pages once more; a page that is not found stands at no place of its own.
    files = [f for f in sorted(folder.rglob("*.html")) if f.name not in ("print.html", "404.html")]
    pages = {f: Page(f.read_text(encoding="utf-8")) for f in files}
    wrong = []
    count = 0
    for file, page in pages.items():
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            count += 1
            path = unquote(parts.path)
            target = (file.parent / path).resolve() if path else file
            if target.is_dir():
                target = target / "index.html"
            if folder not in target.parents or not target.exists():
                wrong.append(f"{file.relative_to(folder)}: {link}")
            elif parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].places:
                wrong.append(f"{file.relative_to(folder)}: {link}: no such place")
    print("\n".join(wrong))
    print(f"{len(pages)} pages, {count} links, {len(wrong)} lead nowhere")
    return 1 if wrong or not count else 0


sys.exit(main(sys.argv[1]))
