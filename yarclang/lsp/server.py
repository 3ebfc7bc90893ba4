"""The language server: the texts that the client opens and changes, and the features that answer its
requests.
"""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable, Generator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import cached_property
from importlib import import_module
from inspect import iscoroutinefunction
from pathlib import Path
from pkgutil import iter_modules
from tempfile import TemporaryDirectory
from threading import Event
from typing import Any

from lsprotocol import types
from pygls.lsp.server import LanguageServer
from pygls.protocol import LanguageServerProtocol
from pygls.protocol.language_server import lsp_method
from pygls.uris import to_fs_path

from yarclang import __version__
from yarclang.assist.calls import Caller, callable_at, outside
from yarclang.assist.hints import ShortestTimes
from yarclang.assist.view import View
from yarclang.lsp import features
from yarclang.lsp.analyses import Analyses, Analysis
from yarclang.lsp.checks import Checks
from yarclang.lsp.documents import Document, changed
from yarclang.lsp.feature import Feature
from yarclang.lsp.modules import Modules
from yarclang.lsp.positions import place_of
from yarclang.lsp.refusal import Outdated
from yarclang.lsp.translation import uri_of
from yarclang.pipeline.inputs import Options
from yarclang.progress import GivenUp, go_on, told_to, unless

_LOG = logging.getLogger(__name__)


class Protocol(LanguageServerProtocol):
    """The Language Server Protocol without pygls's own store of texts. That store would split lines at more
    characters than the protocol does.
    """

    def _execute_handler(
        self,
        msg_id: Any,
        handler: Any,
        callback: Any,
        args: tuple[Any, ...] | None = None,
        kwargs: dict[str, Any] | None = None,
    ) -> None:
        """Call a handler as pygls does, and forget the call when it is done. pygls would remember the calls
        of notifications for ever.
        """
        super()._execute_handler(msg_id, handler, callback, args, kwargs)
        future = self._request_futures.get(msg_id)
        if future is not None:
            future.add_done_callback(lambda _: self._request_futures.pop(msg_id, None))

    @lsp_method(types.TEXT_DOCUMENT_DID_OPEN)
    def lsp_text_document__did_open(
        self, params: types.DidOpenTextDocumentParams
    ) -> Generator[Any, Any, None]:
        """Call only the server's own handler."""
        yield self.fm.features[types.TEXT_DOCUMENT_DID_OPEN], (params,), None

    @lsp_method(types.TEXT_DOCUMENT_DID_CHANGE)
    def lsp_text_document__did_change(
        self, params: types.DidChangeTextDocumentParams
    ) -> Generator[Any, Any, None]:
        """Call only the server's own handler."""
        yield self.fm.features[types.TEXT_DOCUMENT_DID_CHANGE], (params,), None

    @lsp_method(types.TEXT_DOCUMENT_DID_CLOSE)
    def lsp_text_document__did_close(
        self, params: types.DidCloseTextDocumentParams
    ) -> Generator[Any, Any, None]:
        """Call only the server's own handler."""
        yield self.fm.features[types.TEXT_DOCUMENT_DID_CLOSE], (params,), None


class Server(LanguageServer):
    """A language server for one client."""

    def __init__(self, options: Options) -> None:
        super().__init__("yarc", __version__, protocol_cls=Protocol, max_workers=2)
        self.documents: dict[str, Document] = {}
        self.options = options
        self.modules = Modules(self.documents)
        self.checks = Checks(options)
        self.analyses = Analyses(self.checks, self._arrived)
        self.answering = ThreadPoolExecutor(1, thread_name_prefix="answers")
        self.listeners: list[Any] = []
        self.shortest_times = ShortestTimes()
        self.owed: set[str] = set()
        """Texts for which the client has only the results without planning."""
        self.settings: dict[str, Any] = {}
        self._folder: TemporaryDirectory[str] | None = None
        self._views: dict[str, tuple[Document, Analysis | None, View]] = {}
        for feature in found_features():
            self._register(feature)

    def _register(self, feature: Feature) -> None:
        """Register the methods and commands of a feature."""
        for method, (answer, options) in feature.methods.items():
            self.feature(method, options)(self._answering(answer))
        for name, command in (feature.commands or {}).items():
            self.command(name)(self._answering(command))
        if feature.listens is not None:
            self.listeners.append(feature.listens)

    def _answering(self, answer: Callable[..., Any]) -> Callable[..., Any]:
        """Wrap the function that answers a method of the protocol, so that it takes the parameters alone,
        without the server.

        The result is a coroutine function if the original function is one, because pygls treats the two
        differently.
        """

        async def awaited(*params: Any) -> Any:
            return await answer(self, *params)

        def called(*params: Any) -> Any:
            return answer(self, *params)

        return awaited if iscoroutinefunction(answer) else called

    @property
    def encoding(self) -> str:
        """Return the units in which client and server count columns."""
        return str(self.server_capabilities.position_encoding or types.PositionEncodingKind.Utf16)

    def view(self, uri: str) -> View | None:
        """Return the view (text and analysis) of the newest version of an open text; None if the text isn't
        open.
        """
        document = self.documents.get(uri)
        if document is None:
            return None
        analysis = self.analyses.of(uri)
        known = self._views.get(uri)
        if known is not None and known[0] is document and known[1] is analysis:
            return known[2]
        robot = None
        for one in (analysis, self.analyses.last(uri)):
            if robot is None and one is not None and one.checked.opened is not None:
                robot = one.checked.opened.request.robot
        checked = analysis.checked if analysis else None
        older = known[2] if known is not None else None
        if older is not None and not older.is_planned:
            older = older.older
        view = View(document.sketch, checked, robot, self.modules.in_folder(document.folder))
        if not view.is_planned:
            view = replace(view, older=older)
        self._views[uri] = document, analysis, view
        return view

    def program_view(self, uri: str) -> View | None:
        """Return the view of an open program or module; None for other texts."""
        document = self.documents.get(uri)
        return self.view(uri) if document is not None and document.is_program else None

    def views_beside(self, uri: str, *others: str) -> list[View]:
        """Return the views (text and analysis) of the programs and modules in a text's folder, and of other
        files by name.

        Files that are open have the client's content.
        """
        document = self.documents[uri]
        views: dict[str, View] = {}
        for one in self.documents.values():
            view = self.view(one.uri) if one.is_program else None
            if view is not None and (
                one.uri == uri or one.folder == document.folder or one.source.name in others
            ):
                views[one.source.name] = view
        for sketch in self.modules.files(document.folder, others):
            name = sketch.source.name
            if name not in views:
                views[name] = View(sketch, module=self.modules.in_folder(Path(name).parent))
        return list(views.values())

    def caller_of(self, item: types.CallHierarchyItem) -> tuple[Caller, list[View]] | None:
        """Return the SUB or file that an item of the client's call hierarchy stands for, and the views of the
        files in its folder.
        """
        path = to_fs_path(item.uri)
        beside = next((one.uri for one in self.documents.values() if one.is_program), None)
        uri = item.uri if item.uri in self.documents else beside
        if path is None or uri is None:
            return None
        views = self.views_beside(uri, path)
        view = next((one for one in views if one.sketch.source.name == path), None)
        if view is None:
            return None
        source = view.sketch.source
        line, column = place_of(source, item.selection_range.start, self.encoding)
        found = callable_at(view, line, column) if item.kind == types.SymbolKind.Function else outside(view)
        return (found, views) if found is not None else None

    def uri_of(self, name: str) -> str:
        """Return the URI of a file from its name in findings. For an open file, this is the client's URI."""
        open_ = next((one.uri for one in self.documents.values() if one.source.name == name), None)
        return open_ or uri_of(name)

    def roots(self) -> list[Path]:
        """Return the folders of the client; if it has none, the folders of the open texts."""
        uris = [*self.workspace.folders] or ([self.workspace.root_uri] if self.workspace.root_uri else [])
        paths = [Path(path) for uri in uris if (path := to_fs_path(uri))]
        return paths or list(dict.fromkeys(one.folder for one in self.documents.values()))

    @property
    def shows_documents(self) -> bool:
        """Return True if the client lets the server show files.

        This is the initialization option `showDocuments`, true by default.
        """
        return self.settings.get("showDocuments") is not False

    @cached_property
    def files(self) -> Path:
        """Return a temporary folder for files that the client is asked to show. It is deleted when the
        server ends.
        """
        self._folder = TemporaryDirectory(prefix="yarc-lsp-")
        return Path(self._folder.name)

    async def answer(self, uri: str, work: Any, *arguments: Any) -> Any:
        """Run a function about a text in a thread, so that the server can read further messages in the
        meantime, and return the function's result.

        Args:
            uri: URI of the text.
            work: the function to call.
            arguments: arguments of the function.

        Raises:
            Outdated: the text has changed in the meantime.
        """
        document, is_given_up = self.documents.get(uri), Event()

        def is_over() -> bool:
            return is_given_up.is_set() or self.documents.get(uri) is not document

        def done() -> Any:
            with told_to(unless(is_over)):
                go_on()
                return work(*arguments)

        try:
            return await asyncio.get_running_loop().run_in_executor(self.answering, done)
        except GivenUp:
            raise Outdated("the text has changed") from None
        except asyncio.CancelledError:
            is_given_up.set()
            raise

    # Changes of the open texts.

    def opened(self, document: Document) -> None:
        """Store a text that the client has opened, and check it."""
        self.documents[document.uri] = document
        self._lay_out()
        self.analyses.put(document)
        self.modules.changed(document, self.analyses)

    def edited(self, params: types.DidChangeTextDocumentParams) -> None:
        """Apply the client's change to a text."""
        uri = params.text_document.uri
        before = self.documents.get(uri)
        if before is None:
            _LOG.warning("a text was changed that isn't open: %s", uri)
            return
        self.opened(changed(before, params.content_changes, params.text_document.version, self.encoding))

    def closed(self, uri: str) -> None:
        """Forget a text that the client has closed."""
        document = self.documents.pop(uri, None)
        self._views.pop(uri, None)
        self.owed.discard(uri)
        self.analyses.drop(uri)
        self._lay_out()
        if document is not None:
            self.modules.changed(document, self.analyses)

    def touched(self, uri: str) -> None:
        """Check the open texts that depend on a file that was saved, or that another program has changed."""
        self.modules.changed(self.documents.get(uri) or Document(uri, 0, ""), self.analyses)

    def _lay_out(self) -> None:
        """Pass the open texts to the checks, which look up modules, cells and robots among them."""
        self.checks.texts = {one.path: one.source for one in self.documents.values() if one.path}

    def _arrived(self, analysis: Analysis) -> None:
        for listener in self.listeners:
            listener(self, analysis)
        if analysis.is_whole:
            # Cache this view, so that its plan can be used while a newer version of the text has no plan yet.
            self.view(analysis.document.uri)

    def shutdown(self) -> None:
        """Stop all work."""
        self.analyses.close()
        self.answering.shutdown(wait=False, cancel_futures=True)
        if self._folder is not None:
            self._folder.cleanup()
        super().shutdown()  # type: ignore[no-untyped-call]


def found_features() -> tuple[Feature, ...]:
    """Return the features: the FEATURE of each file in lsp/features."""
    names = sorted(module.name for module in iter_modules(features.__path__))
    return tuple(import_module(f"{features.__name__}.{name}").FEATURE for name in names)
