//! What an editor may ask of a program that is open.

use lsp_types::{
    CodeAction, CodeActionKind, CodeActionOrCommand, CodeActionParams, DocumentSymbol, DocumentSymbolParams,
    FoldingRange, FoldingRangeParams, GotoDefinitionParams, Hover, HoverContents, HoverParams, Location,
    MarkupContent, MarkupKind, TextEdit, WorkspaceEdit,
};

use crate::{Editor, Open, Stop, follow, hover, outline};

impl Editor {
    pub(crate) fn hover(&mut self, params: &HoverParams, stop: Stop<'_>) -> Option<Hover> {
        let at = &params.text_document_position_params;
        let Open { place, document, .. } = self.open.get(&at.text_document.uri)?;
        let machine = self.machines.of(place.path()).ok()?;
        let line = u64::from(at.position.line) + 1;
        let value = hover::of(document, place, machine, line, self.language, stop)?;
        let contents = HoverContents::Markup(MarkupContent { kind: MarkupKind::Markdown, value });
        Some(Hover { contents, range: Some(document.whole_line(line)) })
    }

    pub(crate) fn symbols(&mut self, params: &DocumentSymbolParams) -> Vec<DocumentSymbol> {
        self.outlined(&params.text_document.uri).unwrap_or_default()
    }

    pub(crate) fn folds(&mut self, params: &FoldingRangeParams) -> Vec<FoldingRange> {
        outline::folds(&self.outlined(&params.text_document.uri).unwrap_or_default())
    }

    fn outlined(&mut self, uri: &lsp_types::Uri) -> Option<Vec<DocumentSymbol>> {
        let Open { place, document, .. } = self.open.get(uri)?;
        Some(outline::symbols(document, self.machines.dialect(place.path())?))
    }

    pub(crate) fn definition(&mut self, params: &GotoDefinitionParams) -> Option<Location> {
        let at = &params.text_document_position_params;
        let Open { place, document, .. } = self.open.get(&at.text_document.uri)?;
        let machine = self.machines.of(place.path()).ok()?;
        follow::from_line(document, place, machine, u64::from(at.position.line) + 1)
    }

    /// The edits that are the way out of what is said within a range.
    pub(crate) fn actions(&mut self, params: &CodeActionParams) -> Vec<CodeActionOrCommand> {
        let uri = &params.text_document.uri;
        let Some(Open { document, marked: Some(marked), .. }) = self.open.get(uri) else { return Vec::new() };
        let asked = |range: &lsp_types::Range| {
            range.start.line <= params.range.end.line && params.range.start.line <= range.end.line
        };
        let near = marked.iter().filter(|marked| asked(&marked.squiggle.range));
        near.filter_map(|marked| {
            let (help, edit) = marked.mended.as_ref()?;
            let edit = TextEdit { range: document.range(&edit.span), new_text: edit.text.clone() };
            #[expect(clippy::mutable_key_type, reason = "the protocol's type; nothing in it changes")]
            let changes = std::iter::once((uri.clone(), vec![edit])).collect();
            Some(CodeActionOrCommand::CodeAction(CodeAction {
                title: help.clone(),
                kind: Some(CodeActionKind::QUICKFIX),
                diagnostics: Some(vec![marked.squiggle.clone()]),
                edit: Some(WorkspaceEdit { changes: Some(changes), ..WorkspaceEdit::default() }),
                ..CodeAction::default()
            }))
        })
        .collect()
    }
}
