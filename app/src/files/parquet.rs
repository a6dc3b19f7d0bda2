//! A trajectory as Parquet: a column of doubles for each of time, the state's components and energy; what the run was,
//! and what it found of the invariants, in the file's metadata. Rows of ensembles have the member's number before them.

use std::io;
use std::sync::Arc;

use parquet::basic::{Repetition, Type as Physical};
use parquet::data_type::{DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use serde_json::{Map, Value};

use super::NewFile;
use super::run_json::FileOrigin;
use super::table::Rows;

/// Rows that are kept in memory before they are written.
const GROUP: usize = 1 << 14;

pub(super) struct Parquet {
    writer: SerializedFileWriter<NewFile>,
    columns: Vec<Vec<f64>>,
    /// Whether the first column is of members' numbers.
    has_members: bool,
}

impl Parquet {
    pub(super) fn new(file: NewFile, names: &[String], origin: &FileOrigin) -> io::Result<Self> {
        let has_members = names.first().is_some_and(|name| name == "member");
        let writer = || -> Result<_, ParquetError> {
            let fields = names.iter().enumerate().map(|(k, name)| {
                let kind = if k == 0 && has_members { Physical::INT64 } else { Physical::DOUBLE };
                let field = Type::primitive_type_builder(name, kind);
                field.with_repetition(Repetition::REQUIRED).build().map(Arc::new)
            });
            let fields = fields.collect::<Result<Vec<_>, _>>()?;
            let schema = Type::group_type_builder("trajectory").with_fields(fields).build()?;
            // neighbouring states share no values that a dictionary could name
            let properties = WriterProperties::builder().set_dictionary_enabled(false).build();
            let mut writer = SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties))?;
            for (name, value) in origin.fields() {
                writer.append_key_value_metadata(KeyValue::new(name.clone(), value.to_string()));
            }
            Ok(writer)
        };
        let columns = vec![Vec::new(); names.len()];
        Ok(Self { writer: writer().map_err(cause)?, columns, has_members })
    }

    fn write_group(&mut self) -> Result<(), ParquetError> {
        let mut group = self.writer.next_row_group()?;
        for (k, column) in self.columns.iter_mut().enumerate() {
            if let Some(mut writer) = group.next_column()? {
                if k == 0 && self.has_members {
                    let members: Vec<i64> = column.iter().map(|member| *member as i64).collect();
                    writer.typed::<Int64Type>().write_batch(&members, None, None)?;
                } else {
                    writer.typed::<DoubleType>().write_batch(column, None, None)?;
                }
                writer.close()?;
            }
            column.clear();
        }
        group.close()?;
        Ok(())
    }
}

impl Rows for Parquet {
    fn row(&mut self, row: &[f64]) -> io::Result<()> {
        for (column, value) in self.columns.iter_mut().zip(row) {
            column.push(*value);
        }
        match self.columns.first() {
            Some(column) if column.len() >= GROUP => self.write_group().map_err(cause),
            _ => Ok(()),
        }
    }

    fn finish(mut self: Box<Self>, known: &Map<String, Value>) -> io::Result<NewFile> {
        if self.columns.iter().any(|column| !column.is_empty()) {
            self.write_group().map_err(cause)?;
        }
        for (name, value) in known {
            self.writer.append_key_value_metadata(KeyValue::new(name.clone(), value.to_string()));
        }
        self.writer.into_inner().map_err(cause)
    }
}

/// The error of the disk, where it was the disk's.
fn cause(error: ParquetError) -> io::Error {
    match error {
        ParquetError::External(source) => match source.downcast::<io::Error>() {
            Ok(source) => *source,
            Err(source) => io::Error::other(source),
        },
        error => io::Error::other(error),
    }
}
